// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/rate_fit.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "haptics_testing.h"
#include "tissue.h"

namespace palpate::haptics {
namespace {

using ::testing::HasSubstr;

// Presses of a stiffening field of one base ahead of the surface, along z, at several speeds; the
// force with the rate, integrated by Euler's method in steps of 20 us, and noise.
std::vector<RateRecord> pressed_records(const std::vector<RateTerm>& terms, double noise,
                                        int count = 4) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0, noise);
  std::vector<RateRecord> records;
  for (int i = 0; i < count; ++i) {
    RateRecord record{.field = {{{0.9 + 0.2 * i, 2, {0, 0, 4}}, {3, 6}}},
                      .path = {.time = {}, .displacements = Eigen::Matrix3Xd(3, 0), .begins = {}},
                      .forces = Eigen::Matrix3Xd(3, 0)};
    std::vector<Eigen::Vector3d> at, forces;
    double begun = 0;
    for (const double speed : {2.0, 8.0, 30.0}) {
      constexpr double kStep = 2e-5, kDeepest = 3;
      std::vector<double> delayed(terms.size(), 0);
      const auto depth = in_and_out(speed, kDeepest);
      const double duration = 2 * kDeepest / speed;
      const auto steps = std::lround(duration / kStep);
      for (long k = 0; k < steps; ++k) {
        const double now = static_cast<double>(k) * kStep, u = depth(now);
        if (k > 0 && k % (steps / 40) == 0) {
          Eigen::Vector3d f = force(record.field, {0, 0, u});
          for (std::size_t t = 0; t < terms.size(); ++t)
            f += terms[t].share * force(record.field, {0, 0, u - delayed[t]});
          at.emplace_back(0, 0, u);
          forces.push_back(f + Eigen::Vector3d{normal(random), normal(random), normal(random)});
          record.path.begins.push_back(record.path.time.empty() || record.path.time.back() < begun);
          record.path.time.push_back(begun + now);
        }
        for (std::size_t t = 0; t < terms.size(); ++t)
          delayed[t] += kStep / terms[t].time * (u - delayed[t]);
      }
      begun += duration + 20;
    }
    record.path.displacements.resize(3, static_cast<Eigen::Index>(at.size()));
    record.forces.resize(3, static_cast<Eigen::Index>(at.size()));
    for (std::size_t k = 0; k < at.size(); ++k) {
      record.path.displacements.col(static_cast<Eigen::Index>(k)) = at[k];
      record.forces.col(static_cast<Eigen::Index>(k)) = forces[k];
    }
    // Known up to a factor.
    for (Multiquadric& base : record.field.bases) base.weight /= 1.3;
    records.push_back(record);
  }
  return records;
}

TEST(FitRate, FindsTheTermsThatMadeTheForces) {
  constexpr double kNoise = 0.005;
  const std::vector<RateTerm> one = {{0.45, 0.12}};
  const RateFit found = fit_rate(pressed_records(one, kNoise));
  ASSERT_EQ(found.terms.size(), 1u);
  EXPECT_NEAR(found.scale, 1.3, 0.01);
  EXPECT_NEAR(found.terms[0].share, one[0].share, 4 * found.errors[0].share);
  EXPECT_NEAR(found.terms[0].time, one[0].time, 4 * found.errors[0].time);
  EXPECT_LT(found.errors[0].share, 0.02);
  EXPECT_LT(found.errors[0].time, 0.01);
  EXPECT_NEAR(found.rms, std::sqrt(3) * kNoise, 0.001);
  EXPECT_GT(found.rms_without, 5 * found.rms);

  const std::vector<RateTerm> two = {{0.4, 0.03}, {0.5, 0.6}};
  const RateFit both = fit_rate(pressed_records(two, kNoise));
  ASSERT_EQ(both.terms.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(both.terms[i].share, two[i].share, 4 * both.errors[i].share) << i;
    EXPECT_NEAR(both.terms[i].time, two[i].time, 4 * both.errors[i].time) << i;
  }
  EXPECT_EQ(fit_rate(pressed_records(two, kNoise), {.most_terms = 1}).terms.size(), 1u);
}

TEST(FitRate, FindsNoneWhereForcesFollowTheFieldAlone) {
  const RateFit found = fit_rate(pressed_records({}, 0.02));
  EXPECT_TRUE(found.terms.empty());
  EXPECT_TRUE(found.errors.empty());
  EXPECT_NEAR(found.scale, 1.3, 0.01);
  EXPECT_EQ(found.rms, found.rms_without);
}

TEST(FitRate, RefusesRecordsThatAreNoMotion) {
  const std::vector<RateRecord> good = pressed_records({}, 0.01, 1);
  const auto refused = [&](auto&& change) {
    std::vector<RateRecord> bad = good;
    change(bad[0]);
    return refusal([&] { return fit_rate(bad); });
  };
  EXPECT_THAT(refused([](RateRecord& r) { r.path.time[5] = r.path.time[4]; }), HasSubstr("ascend"));
  EXPECT_THAT(refused([](RateRecord& r) { r.path.time.pop_back(); }), HasSubstr("as many"));
  EXPECT_THAT(refused([](RateRecord& r) { r.path.begins[0] = false; }), HasSubstr("begin"));
  EXPECT_THAT(refused([](RateRecord& r) { r.forces(1, 3) = std::nan(""); }), HasSubstr("finite"));
  EXPECT_THAT(refusal([&] { return fit_rate({}); }), HasSubstr("three samples"));
  EXPECT_THAT(refusal([&] { return fit_rate(good, {.most_terms = 3}); }), HasSubstr("most_terms"));
}

}  // namespace
}  // namespace palpate::haptics
