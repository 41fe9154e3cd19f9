// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/acquisition/seeing_prober.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <opencv2/core.hpp>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/probing/probing_program.h"
#include "palpate/probing/quasi_static_arm.h"
#include "palpate/probing/reference_probe.h"
#include "refusal.h"
#include "scratch_folder.h"
#include "seeing_testing.h"
#include "throws_message.h"

namespace palpate::acquisition {
namespace {

namespace fs = std::filesystem;
using Eigen::Vector3d;
using probing::TrialOrder;
using probing::TrialOutcome;
using probing::TrialResult;
using ::testing::HasSubstr;

constexpr double kRadius = 3;  // [mm] of the tip

TrialOrder drag_order(long long trial, int direction = 0) {
  TrialOrder order{.trial = trial,
                   .contact = {.id = 0, .position = {4, 6, 700}, .normal = {0, 0, -1}},
                   .direction = direction,
                   .normal_force = {0, 0, 1.2}};
  if (direction >= 0) order.tangential_force = {0.5, 0, 0};
  return order;
}

/// Shows the same frame again and again.
class StillCamera final : public RestCamera {
 public:
  explicit StillCamera(cv::Mat frame) : frame_(std::move(frame)) {}
  RestPicture look(const Rest& rest) override {
    looks.push_back(rest);
    return {frame_, {}};
  }
  std::vector<Rest> looks;

 private:
  cv::Mat frame_;
};

class SeeingProberTest : public ::testing::Test {
 protected:
  TrialResult run(RestCamera& sees, const TrialOrder& order, const SeeingOptions& options = {}) {
    SeeingProber prober(*arm, sees, decoder(), kRadius, {.base = folder.path(), .truth = "truth"},
                        options);
    return probing::run_trial(prober, order, {});
  }

  static const sensing::Decoder& decoder() {
    static const sensing::Decoder made(support::bundled_setup().rig,
                                       support::bundled_setup().pattern, support::bundled_colors());
    return made;
  }

  const ScratchFolder folder;
  const std::unique_ptr<probing::Prober> arm = probing::make_quasi_static_arm(support::soft_body());
  const std::unique_ptr<RestCamera> camera =
      make_virtual_camera(support::soft_body(), support::bundled_setup());
};

TEST_F(SeeingProberTest, RecordsTheDeformedObjectAndNothingOfTheTool) {
  const TrialResult result = run(*camera, drag_order(12));
  EXPECT_EQ(result.range_map, "range/000012.tiff");
  EXPECT_EQ(result.no_range_map, "");
  const geometry::ImageF seen = geometry::read_depth_tiff(folder / result.range_map);
  const geometry::ImageF truth = geometry::read_depth_tiff(folder / "truth/000012.tiff");
  std::vector<float> errors;
  for (Eigen::Index i = 0; i < seen.size(); ++i)
    if (std::isfinite(seen(i)) && std::isfinite(truth(i)))
      errors.push_back(std::abs(seen(i) - truth(i)));
  ASSERT_GT(errors.size(), 5000U);
  std::sort(errors.begin(), errors.end());
  EXPECT_LT(errors[errors.size() / 2], 0.1);  // 0.01 % of the distance
  EXPECT_LT(errors[errors.size() * 9 / 10], 0.2);
  const auto share =
      static_cast<double>(errors.size()) / static_cast<double>(truth.isFinite().count());
  EXPECT_GT(share, 0.7);
  // Nothing is measured where the tool is, so that the contact itself is hidden.
  const Eigen::Matrix2Xd rays = geometry::pixel_rays(decoder().rig().camera);
  const geometry::PixelMask hidden =
      hidden_by_tool(rays, seen.rows(), {.radius = kRadius}, {result.b, Vector3d::UnitZ()}, 1);
  EXPECT_GT(hidden.count(), 100);
  EXPECT_FALSE((hidden && seen.isFinite()).any());
  // Around it the object is pressed in: the dent is measured.
  EXPECT_GT((seen > 700.4F).count(), 200);
}

TEST_F(SeeingProberTest, ATrialThatIsRepeatedWritesTheSame) {
  const std::string name = run(*camera, drag_order(5)).range_map;
  const std::string before = read_text(folder / name);
  fs::remove(folder / name);
  EXPECT_EQ(run(*camera, drag_order(5)).range_map, name);
  EXPECT_EQ(read_text(folder / name), before);
}

TEST_F(SeeingProberTest, LooksOnceInEachSampleAndAtNothingElse) {
  StillCamera still(cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(0)));
  const TrialResult dragged = run(still, drag_order(0));
  ASSERT_EQ(still.looks.size(), 1U);
  EXPECT_EQ(still.looks[0].tool.tip, dragged.b);
  EXPECT_LT((still.looks[0].tool.inward - Vector3d::UnitZ()).norm(), 1e-12);
  (void)run(still, drag_order(1, -1));
  EXPECT_EQ(still.looks.size(), 2U);
  (void)run(still, drag_order(probing::kFirstReferenceTrial, -1));
  EXPECT_EQ(still.looks.size(), 2U);
  TrialOrder beside = drag_order(2);
  beside.contact.position = {500, 0, 700};
  EXPECT_EQ(run(still, beside).outcome, probing::TrialOutcome::no_contact);
  EXPECT_EQ(still.looks.size(), 2U);
}

TEST_F(SeeingProberTest, APictureOfNoUseLeavesTheTrialAsItIs) {
  StillCamera dark(cv::Mat(480, 640, CV_8UC3, cv::Scalar::all(0)));
  const TrialResult result = run(dark, drag_order(7)),
                    same = probing::run_trial(*arm, drag_order(7), {});
  EXPECT_EQ(result.outcome, probing::TrialOutcome::held);
  EXPECT_EQ(result.b, same.b);
  EXPECT_EQ(result.range_map, "");
  EXPECT_THAT(result.no_range_map, HasSubstr("0 % of the picture"));
  EXPECT_THAT(result.no_range_map, HasSubstr("unlit"));
  EXPECT_FALSE(fs::exists(folder / "range"));
  // The same for too few depths.
  EXPECT_THAT(run(*camera, drag_order(7), {.least_depths = 0.9}).no_range_map,
              HasSubstr("less than 90 %"));
}

TEST_F(SeeingProberTest, AnObjectWithoutAShapeIsTold) {
  class NoShape final : public RestCamera {
    RestPicture look(const Rest&) override { throw SolverError("no equilibrium"); }
  } none;
  const TrialResult result = run(none, drag_order(1));
  EXPECT_EQ(result.outcome, probing::TrialOutcome::held);
  EXPECT_EQ(result.no_range_map, "no equilibrium");
}

TEST_F(SeeingProberTest, ACameraThatFailsEndsTheCampaignAfterTheTrial) {
  class Unplugged final : public RestCamera {
    RestPicture look(const Rest&) override { throw DeviceError("camera: unplugged"); }
  } unplugged;
  SeeingProber prober(*arm, unplugged, decoder(), kRadius, {.base = folder.path()});
  // The tip is lifted from the object first.
  const TrialResult result = probing::run_trial(prober, drag_order(1), {});
  EXPECT_EQ(result.outcome, TrialOutcome::held);
  EXPECT_EQ(result.no_range_map, "camera: unplugged");
  EXPECT_THROWS_MESSAGE((void)probing::run_trial(prober, drag_order(2), {}), DeviceError,
                        "camera: unplugged");
}

TEST_F(SeeingProberTest, MoreFramesMeanLessNoise) {
  // Pictures of the same load differ only by their noise.
  const auto noise_with = [&](int frames) {
    geometry::ImageF depths[2];
    for (const int i : {0, 1}) {
      const TrialResult result = run(*camera, drag_order(i), {.frames = frames});
      depths[i] = geometry::read_depth_tiff(folder / result.range_map);
    }
    std::vector<float> changes;
    for (Eigen::Index i = 0; i < depths[0].size(); ++i)
      if (std::isfinite(depths[0](i)) && std::isfinite(depths[1](i)))
        changes.push_back(std::abs(depths[0](i) - depths[1](i)));
    std::sort(changes.begin(), changes.end());
    return changes[changes.size() / 2];
  };
  // The noise of a mean of n independent frames is sqrt(n) times smaller; n = 9.
  const float quotient = noise_with(1) / noise_with(9);
  EXPECT_GT(quotient, 2.5);
  EXPECT_LT(quotient, 3.5);
}

TEST_F(SeeingProberTest, RefusesOptionsOutsideTheirRange) {
  EXPECT_THAT(refusal([&] { return run(*camera, drag_order(0), {.tool_margin = -1}); }),
              HasSubstr("SeeingOptions::tool_margin"));
}

}  // namespace
}  // namespace palpate::acquisition
