// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "build/pressing_rate.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "haptics_testing.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/playback.h"
#include "sheet_model.h"
#include "synthetic_acquisition.h"
#include "tissue.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

BuildOptions with_rate() {
  BuildOptions options;
  options.rate = true;
  return options;
}

// The force that a model plays for a motion at its middle contact.
std::vector<TissueMoment> played(const Playback& playback,
                                 const std::function<double(double)>& depth, double duration) {
  constexpr double kPlayedTick = 1e-3;
  std::vector<TissueMoment> moments;
  LoopState state;
  static_cast<void>(playback.step({0, 0, 699.9}, state, kPlayedTick));
  for (long k = 0; static_cast<double>(k) * kPlayedTick <= duration; ++k) {
    const double time = static_cast<double>(k) * kPlayedTick;
    const Command command = playback.step({0, 0, 700 + depth(time)}, state, kPlayedTick);
    moments.push_back({time, depth(time), -command.force.z()});
  }
  return moments;
}

// Share of the force that is missing on the way back, in the middle of the depth.
double missing_on_return(const std::vector<TissueMoment>& moments, double depth) {
  double in = 0, out = 0;
  for (std::size_t k = 1; k < moments.size(); ++k) {
    if (moments[k - 1].depth < depth && moments[k].depth >= depth) in = moments[k].force;
    if (moments[k - 1].depth >= depth && moments[k].depth < depth) out = moments[k].force;
  }
  return 1 - out / in;
}

double rms_between(const std::vector<TissueMoment>& a, const std::vector<TissueMoment>& b) {
  double sum = 0;
  for (std::size_t k = 0; k < a.size(); ++k) sum += std::pow(a[k].force - b[k].force, 2);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

TEST(PressedRate, ModelsOfTissueFollowMotionsThatWereNotMeasured) {
  const std::vector<Tissue> tissues = {{}, {.damping = 0.05}};
  for (const Tissue& tissue : tissues) {
    const BuildResult built =
        build_model(tissue_acquisition(tissue, 0.01), flat_surface(), with_rate());
    ASSERT_TRUE(built.rate);
    ASSERT_FALSE(built.rate->terms.empty());
    ASSERT_EQ(built.model.rate.size(), built.rate->terms.size());
    const BuildResult still = build_model(tissue_acquisition(tissue, 0.01), flat_surface());
    EXPECT_TRUE(still.model.rate.empty());
    const Playback playback(built.model), quasi_static(still.model);
    // Between the speeds and frequencies that were measured.
    const auto press = in_and_out(8, 3.5);
    const std::vector<TissueMoment> truth = press_tissue(tissue, press, 0.85, 1e-3);
    const double lost = missing_on_return(truth, 2);
    EXPECT_GT(lost, 0.1);
    EXPECT_LT(lost, 0.4);
    EXPECT_NEAR(missing_on_return(played(playback, press, 0.85), 2), lost, 0.05);
    const double error = rms_between(played(playback, press, 0.85), truth);
    EXPECT_LT(error, 0.3 * rms_between(played(quasi_static, press, 0.85), truth));

    for (const double hertz : {2.0, 3.0}) {
      const auto swing = swinging(2.8, 0.8, hertz);
      const Response right = response_of(press_tissue(tissue, swing, 4, 1e-3), hertz, 4);
      const Response found = response_of(played(playback, swing, 4), hertz, 4);
      constexpr double kDegree = std::numbers::pi / 180;
      EXPECT_GT(right.lead, 2 * kDegree);
      EXPECT_LT(right.lead, 15 * kDegree);
      EXPECT_NEAR(found.lead, right.lead, 1.5 * kDegree) << hertz;
      EXPECT_NEAR(found.ratio, right.ratio, 0.05 * right.ratio) << hertz;
    }
  }
}

TEST(PressedRate, LeavesOutContactsByTheForcesThatStay) {
  const probing::Acquisition acquisition = tissue_acquisition({}, 0.01);
  const BuildResult built = build_model(acquisition, flat_surface(), with_rate());
  const BuildResult still = build_model(acquisition, flat_surface());
  const double with = leave_one_out(built.model, acquisition).rms,
               without = leave_one_out(still.model, acquisition).rms;
  EXPECT_LT(with, 0.6 * without);
}

TEST(PressedRate, IsNotFoundInAnElasticObject) {
  Tissue elastic;
  elastic.damping = 1e-3;  // the second spring follows within 1 ms
  const BuildResult built =
      build_model(tissue_acquisition(elastic, 0.01), flat_surface(), with_rate());
  ASSERT_TRUE(built.rate);
  EXPECT_TRUE(built.rate->terms.empty());
  EXPECT_TRUE(built.model.rate.empty());
}

TEST(PressedRate, IsRefusedWithoutTimesAndWithDrags) {
  probing::Acquisition acquisition = tissue_acquisition({}, 0.01);
  for (probing::Sample& sample : acquisition.samples) sample.time = 0;
  EXPECT_THAT(refusal([&] { return build_model(acquisition, flat_surface(), with_rate()); }),
              HasSubstr("same time"));
  EXPECT_THAT(refusal([&] { return build_model(flat_acquisition(), flat_surface(), with_rate()); }),
              HasSubstr("only pressed"));
}

TEST(PressedPath, BeginsAnewWhereTheToolWasOutsideOrAwayForLong) {
  std::vector<probing::Sample> samples;
  const std::vector<double> depths = {1, -0.2, 2, 1.5, 0.5, 0.7},
                            times = {0.2, 0.1, 0.3, 0.4, 9, 9.1};
  Eigen::Matrix3Xd displacements(3, 6);
  for (std::size_t k = 0; k < depths.size(); ++k) {
    samples.push_back({.id = static_cast<long long>(k), .contact = 4, .time = times[k]});
    displacements.col(static_cast<Eigen::Index>(k)) << 0.1, 0, depths[k];
  }
  const PressedPath found = pressed_path(4, samples, displacements, {0, 0, 1});
  EXPECT_THAT(found.order, ::testing::ElementsAre(1, 0, 2, 3, 4, 5));
  EXPECT_THAT(found.path.begins, ::testing::ElementsAre(true, true, false, false, true, false));
  EXPECT_EQ(found.path.displacements.col(0), Eigen::Vector3d(0, 0, 0));
  EXPECT_EQ(found.path.displacements.col(1), Eigen::Vector3d(0.1, 0, 1));
  samples[3].time = 0.3;
  EXPECT_THAT(refusal([&] {
                return pressed_path(4, samples, displacements, {0, 0, 1});
              }),
              HasSubstr("contact 4"));
}

}  // namespace
}  // namespace palpate::haptics
