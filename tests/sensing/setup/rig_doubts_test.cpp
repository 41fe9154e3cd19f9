// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/rig_doubts.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "repository.h"

namespace palpate::sensing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

Rig bundled_rig() { return read_rig(repository("demo/rig.yaml")); }

std::vector<Doubt> with_baseline(double mm) {
  Rig rig = bundled_rig();
  rig.T_projector_camera.translation() *= mm / rig.T_projector_camera.translation().norm();
  return rig_doubts(rig);
}

/// 640 x 480 px.
geometry::Camera camera_of(double focal, double cx = 318.5, double cy = 242) {
  return {.width = 640, .height = 480, .fx = focal, .fy = focal, .cx = cx, .cy = cy};
}

TEST(RigDoubts, NothingIsSaidOfRigsOfUsualSizes) {
  for (const std::string name : {"demo/rig.yaml", "demo/verging/rig.yaml"})
    EXPECT_THAT(rig_doubts(read_rig(repository(name))), IsEmpty()) << name;
  for (const double mm : {10.0, 25.0, 120.0, 224.0, 1000.0, 4900.0})
    EXPECT_THAT(with_baseline(mm), IsEmpty()) << mm;
}

TEST(RigDoubts, TinyAndHugeRigsAreUnlikelyButPossible) {
  for (const double mm : {2.0, 5.0, 9.0, 6000.0, 20000.0}) {
    ASSERT_THAT(with_baseline(mm), SizeIs(1)) << mm;
    EXPECT_FALSE(with_baseline(mm)[0].impossible) << mm;
  }
}

// The bundled rig, 223.9 mm wide, read as if its numbers were mm.
TEST(RigDoubts, AWrongUnitIsNamedWithTheLengthThatItWouldGive) {
  const auto doubt = [](double baseline) {
    const std::vector<Doubt> doubts = with_baseline(baseline);
    return doubts.size() == 1 ? doubts[0] : Doubt{};
  };
  EXPECT_TRUE(doubt(0.2239).impossible);
  EXPECT_THAT(doubt(0.2239).message, HasSubstr("223.9 mm if the number is in metres"));
  EXPECT_FALSE(doubt(223.9 / 25.4).impossible);
  EXPECT_THAT(doubt(223.9 / 25.4).message, HasSubstr("223.9 mm if the number is in inches"));
  EXPECT_TRUE(doubt(223.9e3).impossible);
  EXPECT_THAT(doubt(223.9e3).message, HasSubstr("223.9 mm if the number is in micrometres"));
}

TEST(RigDoubts, CamerasOfUsualAnglesAndPartsOfLargerImagesAreBelieved) {
  for (const double focal : {250.0, 476.0, 1100.0, 5000.0, 2e5})
    EXPECT_THAT(camera_doubts(camera_of(focal)), IsEmpty()) << focal;
  // A part of 484 x 152 px of a larger image, of real captures.
  EXPECT_THAT(
      camera_doubts(
          {.width = 484, .height = 152, .fx = 2445.65, .fy = 2445.65, .cx = 483.5, .cy = 607.5}),
      IsEmpty());
  EXPECT_THAT(camera_doubts({.width = 1, .height = 1, .fx = 1, .fy = 1}), IsEmpty());
}

TEST(RigDoubts, AFocalLengthInMillimetresCannotBe) {
  const std::vector<Doubt> doubts = camera_doubts(camera_of(5.8));
  ASSERT_THAT(doubts, SizeIs(1));
  EXPECT_TRUE(doubts[0].impossible);
  // atan(sqrt(320.5^2 + 242^2) / 5.8)
  EXPECT_THAT(doubts[0].message, HasSubstr("89 degrees from the optical axis"));
  EXPECT_THAT(doubts[0].message, HasSubstr("focal length in mm"));
  EXPECT_THAT(camera_doubts(camera_of(1e6)), SizeIs(1));  // in micrometres
}

TEST(RigDoubts, APrincipalPointFarOutsideTheImageIsDoubtedInACameraOnly) {
  for (const auto& [cx, cy] : {std::pair{2000.0, 242.0}, {900.0, 242.0}, {318.5, -300.0}}) {
    const std::vector<Doubt> doubts = camera_doubts(camera_of(580, cx, cy));
    ASSERT_THAT(doubts, SizeIs(1)) << cx << ' ' << cy;
    EXPECT_EQ(doubts[0].subject, "camera");
    EXPECT_FALSE(doubts[0].impossible);
  }
  Rig shifted = bundled_rig();
  shifted.projector.cy = -500;  // a lens that is shifted by more than its image
  EXPECT_THAT(rig_doubts(shifted), IsEmpty());
  shifted.projector.fx = shifted.projector.fy = 15;
  ASSERT_THAT(rig_doubts(shifted), SizeIs(1));
  EXPECT_EQ(rig_doubts(shifted)[0].subject, "projector");
}

TEST(RigDoubts, DepthsTellTheScaleOfADepthImage) {
  for (const double mm : {12.0, 700.0, 9e3, 5e4}) EXPECT_THAT(depth_doubts(mm), IsEmpty()) << mm;
  EXPECT_THAT(depth_doubts(std::nan("")), IsEmpty());
  ASSERT_THAT(depth_doubts(0.7), SizeIs(1));
  EXPECT_TRUE(depth_doubts(0.7)[0].impossible);
  EXPECT_THAT(depth_doubts(0.7)[0].message, HasSubstr("700 mm if the number is in metres"));
  EXPECT_TRUE(depth_doubts(7e14).at(0).impossible);
  EXPECT_FALSE(depth_doubts(1.7).at(0).impossible);
  EXPECT_FALSE(depth_doubts(2e6).at(0).impossible);
}

/// What is said of a sinusoid along the rows of the projector, with a baseline at an angle to it.
std::string doubt_at_angle(double degrees, const Eigen::Matrix3d& rotation, double forward = 0) {
  Rig rig = bundled_rig();
  const double angle = degrees * std::numbers::pi / 180;
  rig.T_projector_camera.linear() = rotation;
  rig.T_projector_camera.translation() =
      rotation * Eigen::Vector3d(200 * std::sin(angle), 200 * std::cos(angle), forward);
  const std::vector<Doubt> doubts = sinusoid_doubts(rig, {.axis = Axis::y, .period = 10});
  EXPECT_LE(doubts.size(), 1U);
  if (doubts.empty()) return {};
  EXPECT_EQ(doubts[0].subject, "axis");
  EXPECT_FALSE(doubts[0].impossible);
  return doubts[0].message;
}

TEST(RigDoubts, ASinusoidAcrossTheBaselineIsToldWithTheOtherAxis) {
  const Eigen::Matrix3d parallel = Eigen::Matrix3d::Identity();
  for (const double degrees : {0.0, 45.0, -50.0, 58.0, 125.0, 180.0})  // along to oblique
    EXPECT_EQ(doubt_at_angle(degrees, parallel), "") << degrees;
  EXPECT_THAT(doubt_at_angle(62, parallel), HasSubstr("only 47 %"));  // its cosine
  EXPECT_THAT(doubt_at_angle(-70, parallel), HasSubstr("only 34 %"));
  const std::string across = doubt_at_angle(90, parallel);
  EXPECT_THAT(across, HasSubstr("only 0 %"));
  EXPECT_THAT(across, HasSubstr("--axis x (100 %)"));
  Rig rig = bundled_rig();
  rig.T_projector_camera.translation() = Eigen::Vector3d(60, 190, 0);  // 30 %
  EXPECT_THAT(sinusoid_doubts(rig, {.axis = Axis::x, .period = 10}).at(0).message,
              HasSubstr("only 30 % of the baseline"));
  EXPECT_THAT(sinusoid_doubts(rig, {.axis = Axis::x, .period = 10}).at(0).message,
              HasSubstr("--axis y (95 %)"));
}

// The panel, not the camera, has the sinusoid: with a projector that is rolled by a quarter turn,
// another axis of it lies along the baseline.
TEST(RigDoubts, TheBaselineIsSeenFromTheProjector) {
  const Eigen::Matrix3d rolled =
      Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  EXPECT_THAT(doubt_at_angle(0, rolled), HasSubstr("only 0 %"));
  EXPECT_EQ(doubt_at_angle(90, rolled), "");
  const Eigen::Matrix3d verging =
      Eigen::AngleAxisd(-0.5, Eigen::Vector3d::UnitX()).toRotationMatrix();
  EXPECT_EQ(doubt_at_angle(0, verging, -40), "");
  EXPECT_THAT(doubt_at_angle(90, verging), HasSubstr("--axis x"));
  // Straight before the camera: all directions alike, as the rays spread.
  Rig rig = bundled_rig();
  rig.T_projector_camera.translation() = Eigen::Vector3d(0, 0, 100);
  EXPECT_THAT(sinusoid_doubts(rig, {.axis = Axis::x, .period = 10}), IsEmpty());
}

TEST(RigDoubts, ARangeMapIsJudgedByItsKnownDepths) {
  geometry::RangeMap map{geometry::ImageF::Constant(480, 640, 700), camera_of(580)};
  EXPECT_THAT(range_map_doubts(map), IsEmpty());
  map.z.topRows(200) = std::numeric_limits<float>::quiet_NaN();
  map.z.bottomRows(3) = 1e-3F;  // a few wrong ones
  EXPECT_THAT(range_map_doubts(map), IsEmpty());
  map.z *= 1e-3F;
  EXPECT_THAT(impossible_parts(range_map_doubts(map)), HasSubstr("depths: half of them"));
  map.z = std::numeric_limits<float>::quiet_NaN();
  EXPECT_THAT(range_map_doubts(map), IsEmpty());
}

}  // namespace
}  // namespace palpate::sensing
