// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/friction_axis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <numbers>
#include <random>

#include "haptics_testing.h"
#include "palpate/haptics/rotation.h"
#include "strip_acquisition.h"

namespace palpate::haptics {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kPi = std::numbers::pi;
constexpr double kRounding = 1e-9;
const Vector3d kConeAxis = Vector3d(0.1, -0.05, 0.9).normalized();

double angle_between(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

// An object whose friction boundary lies about `tilt` at each level.
struct Object {
  Vector2d tilt{0.15, -0.1};
  Eigen::Matrix2d across = (Eigen::Matrix2d() << 3, 0.4, -0.2, 0.8).finished();
  double friction = 0.8;
  double scatter = 0;  ///< of the ratios
  double noise = 0;    ///< [mm] of displacements
};

struct AxisProbing {
  std::vector<double> angles{0,   kPi / 4,      kPi / 2,  3 * kPi / 4,
                             kPi, -3 * kPi / 4, -kPi / 2, -kPi / 4};
  std::vector<double> depths{1, 3, 6, 10, 14};  ///< [mm] one for each level of force
  bool settled = true;
};

Vector3d axis_of(const Object& object) {
  return rotation_between(Vector3d::UnitZ(), kConeAxis) *
         Vector3d(object.tilt.x(), object.tilt.y(), 1).normalized();
}

// Pairs on the boundary, and the settled ones, that follow the linear law up to noise.
ForceSamples pairs_of(const Object& object, const AxisProbing& probing = {}, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const Eigen::Matrix3d frame = rotation_between(Vector3d::UnitZ(), kConeAxis);
  ForceSamples samples;
  std::vector<Vector3d> forces, displacements;
  const auto add = [&](PairKind kind, double depth, const Vector2d& ratio) {
    const Vector2d scatter{normal(random), normal(random)};
    const Vector2d observed = object.tilt + object.across * ratio + object.scatter * scatter;
    const Vector3d noise{normal(random), normal(random), normal(random)};
    const double level = depth / 4;  // [N]
    forces.emplace_back(frame * Vector3d(level * ratio.x(), level * ratio.y(), level));
    displacements.emplace_back(
        frame *
        (Vector3d(depth * observed.x(), depth * observed.y(), depth) + object.noise * noise));
    samples.kinds.push_back(kind);
  };
  for (const double depth : probing.depths) {
    // The arm presses along a normal that is not the cone's axis.
    if (probing.settled) add(PairKind::settled, depth, {-0.1, 0.05});
    for (const double angle : probing.angles) {
      add(PairKind::friction_boundary, depth,
          object.friction * Vector2d(std::cos(angle), std::sin(angle)));
    }
  }
  samples.forces = Eigen::Map<Eigen::Matrix3Xd>(forces.front().data(), 3,
                                                static_cast<Eigen::Index>(forces.size()));
  samples.displacements = Eigen::Map<Eigen::Matrix3Xd>(
      displacements.front().data(), 3, static_cast<Eigen::Index>(displacements.size()));
  return samples;
}

TEST(FitFrictionAxis, IsTheDirectionWithoutForceAcrossWhereverTheDirectionsLie) {
  for (const std::vector<double>& angles :
       {AxisProbing{}.angles, std::vector<double>{-0.9, -0.3, 0.2, 0.8, 1.5},
        std::vector<double>{0, 0.1, 0.2, 2, 4}}) {
    const FrictionAxisFit fit = fit_friction_axis(pairs_of({}, {.angles = angles}), kConeAxis);
    EXPECT_EQ(fit.stop, FrictionAxisStop::converged);
    EXPECT_EQ(fit.pairs, static_cast<int>(5 * (angles.size() + 1)));
    EXPECT_LT(angle_between(*fit.axis, axis_of({})), kRounding);
    EXPECT_NEAR(fit.axis->norm(), 1, kRounding);
    EXPECT_LT(*fit.error, kRounding);
  }
}

TEST(FitFrictionAxis, IsAsExactAsItsErrorSays) {
  for (const std::vector<double>& angles :
       {AxisProbing{}.angles, std::vector<double>{-1.4, -0.7, 0, 0.7, 1.4}}) {
    constexpr unsigned kCount = 400;
    const Object object{.scatter = 0.1, .noise = 0.03};
    double squares = 0;
    for (unsigned seed = 0; seed < kCount; ++seed) {
      const FrictionAxisFit fit =
          fit_friction_axis(pairs_of(object, {.angles = angles}, seed), kConeAxis);
      ASSERT_EQ(fit.stop, FrictionAxisStop::converged);
      squares += std::pow(angle_between(*fit.axis, axis_of(object)) / *fit.error, 2) / kCount;
    }
    // Mean of 400 squares with two degrees of freedom: 1 +- 0.05.
    EXPECT_NEAR(squares, 1, 0.2);
  }
}

// The levels' axes lie apart by what the deepest alone would not tell.
TEST(FitFrictionAxis, CountsAllLevelsAlike) {
  ForceSamples samples = pairs_of({.tilt = {0.2, 0}}, {.depths = {1}});
  const ForceSamples deep = pairs_of({.tilt = {0, 0}}, {.depths = {14}});
  ForceSamples both = samples;
  both.forces.resize(3, samples.forces.cols() + deep.forces.cols());
  both.forces << samples.forces, deep.forces;
  both.displacements.resize(3, both.forces.cols());
  both.displacements << samples.displacements, deep.displacements;
  both.kinds.insert(both.kinds.end(), deep.kinds.begin(), deep.kinds.end());
  const FrictionAxisFit fit = fit_friction_axis(both, kConeAxis);
  // The noise of the shallow level takes a part of its weight.
  EXPECT_LT(angle_between(*fit.axis, axis_of({.tilt = {0.1, 0}})), 0.03);
}

TEST(FitFrictionAxis, StaysWithTheMajorityAgainstOutliers) {
  ForceSamples samples = pairs_of({.scatter = 0.05});
  for (Eigen::Index i = 3; i < samples.forces.cols(); i += 9)
    samples.displacements.col(i) += Vector3d(20, 20, 0);
  const FrictionAxisFit fit = fit_friction_axis(samples, kConeAxis);
  EXPECT_LT(angle_between(*fit.axis, axis_of({})), 0.05);
}

TEST(FitFrictionAxis, TurnsWithThePairsTakesAnyUnitsAndAnyOrder) {
  const ForceSamples samples = pairs_of({.scatter = 0.1, .noise = 0.03});
  const FrictionAxisFit fit = fit_friction_axis(samples, kConeAxis);
  ForceSamples turned = samples;
  const double length = 1e-3, force = 1e4;
  turned.displacements = length * some_rotation() * samples.displacements.rowwise().reverse();
  turned.forces = force * some_rotation() * samples.forces.rowwise().reverse();
  std::reverse(turned.kinds.begin(), turned.kinds.end());
  const FrictionAxisFit other =
      fit_friction_axis(turned, 3 * some_rotation() * kConeAxis,
                        {.displacement_noise = length * 0.03, .force_noise = force * 0.01});
  EXPECT_EQ(other.pairs, fit.pairs);
  EXPECT_LT(angle_between(*other.axis, some_rotation() * *fit.axis), kRounding);
  EXPECT_NEAR(*other.error, *fit.error, kRounding);
}

TEST(FitFrictionAxis, TellsWhatIsLacking) {
  const auto expect_none = [](const ForceSamples& samples, FrictionAxisStop stop) {
    const FrictionAxisFit fit = fit_friction_axis(samples, kConeAxis);
    EXPECT_EQ(fit.stop, stop) << to_string(fit.stop);
    EXPECT_FALSE(fit.axis);
    EXPECT_FALSE(fit.error);
  };
  expect_none({}, FrictionAxisStop::too_few_pairs);
  expect_none(pairs_of({}, {.angles = {}}), FrictionAxisStop::too_few_pairs);
  // Hardly more than the noise moves.
  expect_none(pairs_of({}, {.depths = {0.05, 0.06, 0.08}}), FrictionAxisStop::too_few_pairs);
  // In a line through the axis only, and settled pairs alone.
  expect_none(pairs_of({}, {.angles = {0.3, 0.3 + kPi}, .settled = false}),
              FrictionAxisStop::too_few_directions);
  expect_none(pairs_of({}, {.angles = {}, .depths = {2, 4, 6, 8, 10, 12, 14}}),
              FrictionAxisStop::too_few_directions);
  // Directions within 6 degrees, without settled pairs: the axis is a guess far from all of them.
  const FrictionAxisFit fit = fit_friction_axis(
      pairs_of({.scatter = 0.1}, {.angles = {0, 0.05, 0.1}, .settled = false}), kConeAxis);
  EXPECT_EQ(fit.stop, FrictionAxisStop::uncertain);
  EXPECT_GT(*fit.error, 0.15);
}

TEST(FitFrictionAxis, RefusesWhatIsNotFiniteOrOutOfRange) {
  ForceSamples samples = pairs_of({});
  EXPECT_THAT(refusal([&] { return fit_friction_axis(samples, Vector3d::Zero()); }),
              ::testing::HasSubstr("axis"));
  EXPECT_THAT(
      refusal([&] { return fit_friction_axis(samples, kConeAxis, {.displacement_noise = -1}); }),
      ::testing::HasSubstr("displacement_noise"));
  EXPECT_THAT(refusal([&] { return fit_friction_axis(samples, kConeAxis, {.force_noise = 0}); }),
              ::testing::HasSubstr("force_noise"));
  const double nan = std::numeric_limits<double>::quiet_NaN();
  samples.displacements(1, 7) = nan;
  EXPECT_THAT(refusal([&] { return fit_friction_axis(samples, kConeAxis); }),
              ::testing::HasSubstr("pair 7"));
  samples.kinds.pop_back();
  EXPECT_THAT(refusal([&] { return fit_friction_axis(samples, kConeAxis); }),
              ::testing::HasSubstr("kinds"));
}

// Against where the sheet goes without force across the cone's axis, at five levels. No one axis is
// nearer to all of them than 3.6 degrees (RMS); a mean of the displacements of a half-plane is off
// by 14.
TEST(FitFrictionAxis, IsThatOfASheetAlsoFromHalfOfTheDirections) {
  const support::Strip strip;
  double squares = 0, half_squares = 0, mean_squares = 0;
  int count = 0;
  for (const Vector2d& at :
       {Vector2d(-14, -20), Vector2d(0, 0), Vector2d(28, 0), Vector2d(7, 40)}) {
    const probing::Acquisition acquisition = support::strip_contact(at.x(), at.y(), strip);
    const Eigen::Matrix3d frame = support::strip_frame(at.x(), at.y());
    const Vector3d cone = support::strip_cone(strip, at.x(), at.y()).axis;
    const auto fitted = [&](const probing::Acquisition& measured) {
      return fit_friction_axis(realign(measured.contacts[0], measured.samples),
                               frame.transpose() * cone);
    };
    probing::Acquisition half = acquisition;
    std::erase_if(half.samples, [&](const probing::Sample& sample) {
      const Vector3d force = frame * sample.force;
      return force.head<2>().norm() > 0 && force.x() < 0;
    });
    Vector3d mean = Vector3d::Zero();
    for (const probing::Sample& sample : half.samples) {
      if (sample.on_friction_boundary) mean += sample.b - half.contacts[0].position;
    }
    const FrictionAxisFit fit = fitted(acquisition), half_fit = fitted(half);
    EXPECT_EQ(fit.stop, FrictionAxisStop::converged);
    EXPECT_EQ(half_fit.stop, FrictionAxisStop::converged);
    for (const double level : {0.15, 0.5, 1.1, 2.0, 3.0}) {
      const Vector3d truth =
          frame.transpose() * support::strip_displacement(strip, at.x(), at.y(), level * cone);
      squares += std::pow(angle_between(*fit.axis, truth), 2);
      half_squares += std::pow(angle_between(*half_fit.axis, truth), 2);
      mean_squares += std::pow(angle_between(mean, truth), 2);
      ++count;
    }
  }
  constexpr double kDegree = kPi / 180;
  EXPECT_LT(std::sqrt(squares / count), 4.2 * kDegree);
  EXPECT_LT(std::sqrt(half_squares / count), 4.4 * kDegree);
  EXPECT_GT(std::sqrt(mean_squares / count), 2 * std::sqrt(half_squares / count));
}

}  // namespace
}  // namespace palpate::haptics
