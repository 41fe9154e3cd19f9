// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/arm_setup.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "palpate/core/error.h"
#include "palpate/probing/arm_reach.h"
#include "palpate/probing/closed_form.h"
#include "refusal.h"

namespace palpate::probing {
namespace {

using Eigen::Vector3d;

TEST(ArmSetup, TakesItsMembersAndKeepsTheDefaultsOfTheOthers) {
  const ArmSetup setup = parse_arm_setup(
      R"({"pose": [[0, 0, 1, 5], [1, 0, 0, 6], [0, 1, 0, 7]], "structure": 2, "mass": 0.1,
          "geometry": {"upper": 200}, "limits": {"depth": 30, "workspace": [[-1, -2, -3], [1, 2, 3]]},
          "dither": 0, "dither_frequency": 9, "presliding": 1e-4,
          "links": {"distance": 12}, "calibration": {"angles": 9, "low": [-0.4, 0, -0.3]}, "driver": {"port": "usb0", "n": 3}})",
      "arm.json");
  EXPECT_TRUE(setup.knows_pose);
  EXPECT_EQ(setup.prober.T_world_base * Vector3d(1, 2, 3), Vector3d(8, 7, 9));
  EXPECT_EQ(setup.prober.structure, 2);
  EXPECT_EQ(setup.prober.contact.model.mass, 0.1);
  EXPECT_EQ(setup.prober.dither, 0);
  EXPECT_EQ(setup.prober.dither_frequency, 9);
  EXPECT_EQ(setup.prober.presliding, 1e-4);
  EXPECT_EQ(setup.prober.geometry.upper, 200);
  EXPECT_EQ(setup.prober.geometry.lower, ArmGeometry{}.lower);
  EXPECT_EQ(setup.prober.limits.depth, 30);
  EXPECT_EQ(setup.prober.limits.workspace.min(), Vector3d(-1, -2, -3));
  EXPECT_EQ(setup.links.distance, 12);
  EXPECT_EQ(setup.links.free_end, LinkClearance{}.free_end);
  EXPECT_EQ(setup.prober.calibration.angles, 9);
  EXPECT_EQ(setup.prober.calibration.low, Vector3d(-0.4, 0, -0.3));
  EXPECT_EQ(setup.driver.at("port"), "usb0");
  EXPECT_EQ(setup.driver.at("n"), "3");
  EXPECT_FALSE(parse_arm_setup("{}", "arm.json").knows_pose);
}

TEST(ArmSetup, NamesTheMemberThatIsWrong) {
  const auto refused = [](const char* text) {
    return refusal([&] { return parse_arm_setup(text, "arm.json"); });
  };
  EXPECT_EQ(refused(R"({"structure": 0})"),
            "arm.json: at /structure: found 0, expected a number > 0 and finite [N/mm]");
  EXPECT_EQ(refused(R"({"calibration": {"angles": 2}})"),
            "arm.json: at /calibration/angles: found 2, expected a whole number >= 3");
  EXPECT_NE(
      refused(R"({"limits": {"velocity": 3}})").find("at /limits/velocity: 'velocity' is unknown"),
      std::string::npos);
  EXPECT_NE(refused(R"({"pose": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0]]})").find("a rotation"),
            std::string::npos);
  EXPECT_NE(refused("[1]").find("expected an object"), std::string::npos);
  EXPECT_NE(refused(R"({"calibration": 5})").find("expected an object"), std::string::npos);
}

TEST(ArmSetup, AMountedArmStandsUprightOverTheSurfaceAndSweepsAboveIt) {
  const std::shared_ptr<const Specimen> sheet = make_specimen(Sheet{}),
                                        beam = make_specimen(Beam{});
  for (const Specimen* specimen : {sheet.get(), beam.get()}) {
    const ArmGeometry geometry;
    const Eigen::Isometry3d T_world_base = mount_over(specimen->surface(), geometry);
    EXPECT_NEAR(T_world_base.linear().determinant(), 1, 1e-12);
    EXPECT_GT(T_world_base.linear().col(1).dot(-Vector3d::UnitZ()), 0.999);  // towards the camera
    const Eigen::Matrix3Xd in_base = T_world_base.inverse() * specimen->surface().vertices;
    const double top = in_base.row(1).maxCoeff();
    for (Eigen::Index i = 0; i < in_base.cols(); ++i) {
      ASSERT_EQ(reach_of(specimen->surface().vertices.col(i), {.T_world_base = T_world_base}),
                Reach::reachable);
    }
    const GravityCalibration sweeps = sweeps_above_surface();
    // Beyond its ends a sweep goes by a step and the slow last part.
    const Vector3d beyond =
        (sweeps.high - sweeps.low) / (sweeps.angles - 1) + Vector3d::Constant(0.02);
    double lowest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 8; ++k) {
      Vector3d joints;
      for (int i = 0; i < 3; ++i)
        joints[i] = (k >> i & 1) != 0 ? sweeps.high[i] + beyond[i] : sweeps.low[i] - beyond[i];
      lowest = std::min(lowest, tip_position(geometry, joints).y());
    }
    EXPECT_GT(lowest - top, 20);
  }
}

TEST(ArmSetup, TakesAnotherPoseAndKeepsAllElse) {
  const std::string text =
      R"({"structure": 3.25, "driver": {"port": "/dev/tty\u00fc"}, "pose": [[1, 0, 0, 1], [0, 1, 0, 2],
          [0, 0, 1, 3]], "calibration": {"angles": 9}})";
  Eigen::Isometry3d pose(Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()));
  pose.translation() << 0.1, -200, 1e-7;
  const std::string changed = with_pose(text, "arm.json", pose);
  const ArmSetup setup = parse_arm_setup(changed, "arm.json");
  EXPECT_EQ(setup.prober.T_world_base.matrix(), pose.matrix());
  EXPECT_EQ(setup.prober.structure, 3.25);
  EXPECT_EQ(setup.prober.calibration.angles, 9);
  EXPECT_EQ(setup.driver.at("port"), "/dev/tty\u00fc");
  EXPECT_EQ(changed.find("structure"), 2U);  // the members stay in their order
  EXPECT_TRUE(parse_arm_setup(with_pose("{}", "arm.json", pose), "arm.json").knows_pose);
  EXPECT_EQ(refusal([&] { (void)with_pose("[1]", "arm.json", pose); }).substr(0, 8), "arm.json");
  EXPECT_EQ(refusal([&] { (void)with_pose(R"({"pole": 1})", "arm.json", pose); }).substr(0, 18),
            "arm.json: at /pole");
}

}  // namespace
}  // namespace palpate::probing
