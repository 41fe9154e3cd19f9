// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/force_surrogate.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/probing/closed_form.h"
#include "sticking_ball.h"

namespace palpate::probing {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

// Forces in a cone about z, of every size up to `most`.
std::vector<Vector3d> forces_in_cone(int count, double most) {
  std::vector<Vector3d> forces;
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * std::fmod(i * std::numbers::phi, 1);
    const double ratio = 0.7 * std::sqrt(std::fmod(i * std::numbers::sqrt2, 1));
    const Vector3d along(ratio * std::cos(angle), ratio * std::sin(angle), 1);
    forces.push_back(most * (i + 1) / count * along.normalized());
  }
  return forces;
}

template <typename Law>
std::vector<ForcePair> pairs_of(const std::vector<Vector3d>& forces, const Law& law) {
  std::vector<ForcePair> pairs;
  for (const Vector3d& force : forces) pairs.push_back({force, law(force)});
  return pairs;
}

Vector3d foam(const Vector3d& force) { return indentation(Beam{}, force); }

// Two forces determine the six numbers of a symmetric compliance, except for what is smooth.
TEST(ForceSurrogate, ReproducesALinearElasticContact) {
  Matrix3d compliance;
  compliance << 0.8, 0.1, 0.2, 0.1, 0.5, -0.1, 0.2, -0.1, 1.5;
  const auto law = [&](const Vector3d& f) -> Vector3d { return compliance * f; };
  const ForceSurrogate surrogate(pairs_of(forces_in_cone(20, 3), law),
                                 {.position_noise = 1e-5, .force_noise = 0});
  for (const Vector3d& force : forces_in_cone(13, 2.9)) {
    EXPECT_LT((surrogate.predict(force).mean - law(force)).norm(), 1e-3) << force.transpose();
    EXPECT_LT((surrogate.compliance(force) - compliance).norm(), 0.01) << force.transpose();
  }
}

TEST(ForceSurrogate, FollowsStiffeningFoamBetweenItsMeasurements) {
  const ForceSurrogate surrogate(pairs_of(forces_in_cone(25, 3), foam), {.position_noise = 0.01});
  for (const Vector3d& force : forces_in_cone(13, 2.9)) {
    const PredictedDisplacement expected = surrogate.predict(force);
    EXPECT_LT((expected.mean - foam(force)).norm(), 0.1) << force.transpose();
    EXPECT_LT((expected.mean - foam(force)).norm(), 5 * std::sqrt(expected.covariance.trace()));
  }
}

// The displacement is a gradient, so its derivative is symmetric: by differences, no use of the
// class's own derivative.
TEST(ForceSurrogate, IsTheGradientOfAnEnergy) {
  const ForceSurrogate surrogate(pairs_of(forces_in_cone(12, 3), foam));
  const double h = 1e-4;
  for (const Vector3d& force : forces_in_cone(5, 2)) {
    Matrix3d slope;
    for (int k = 0; k < 3; ++k) {
      const Vector3d step = h * Vector3d::Unit(k);
      slope.col(k) =
          (surrogate.predict(force + step).mean - surrogate.predict(force - step).mean) / (2 * h);
    }
    EXPECT_LT((slope - slope.transpose()).norm(), 1e-5 * slope.norm());
  }
}

TEST(ForceSurrogate, IsTheSameInAllFrames) {
  const Eigen::Quaterniond turn = Eigen::Quaterniond(0.3, -0.5, 0.7, 0.2).normalized();
  const auto forces = forces_in_cone(12, 3);
  std::vector<ForcePair> pairs = pairs_of(forces, foam), turned;
  for (const ForcePair& pair : pairs)
    turned.push_back({turn * pair.force, turn * pair.displacement});
  const ForceSurrogate one(pairs), other(turned);
  for (const Vector3d& force : forces_in_cone(5, 2.7)) {
    const PredictedDisplacement a = one.predict(force), b = other.predict(turn * force);
    EXPECT_LT((turn * a.mean - b.mean).norm(), 1e-9);
    EXPECT_NEAR(a.covariance.trace(), b.covariance.trace(), 1e-9);
  }
}

TEST(ForceSurrogate, VarianceFallsWithSamplesAsReductionsSay) {
  const auto queries = forces_in_cone(8, 2.8);
  // At a linear contact a measurement changes neither compliance nor scale.
  const auto law = [](const Vector3d& f) -> Vector3d { return 0.7 * f; };
  std::vector<ForcePair> pairs = pairs_of(forces_in_cone(6, 3), law);
  double before = ForceSurrogate(pairs).error_variance(queries);
  for (const Vector3d& candidate : {Vector3d(0.5, 0.2, 1.1), Vector3d(-0.4, 0.9, 2.2)}) {
    const double reduction = ForceSurrogate(pairs).reductions(queries, {{candidate}}).front();
    EXPECT_GT(reduction, 0);
    pairs.push_back({candidate, law(candidate)});
    const double after = ForceSurrogate(pairs).error_variance(queries);
    EXPECT_NEAR(before - after, reduction, 0.05 * reduction);
    before = after;
  }
}

// Against surrogates that were made without one pair each. Their scale differs by some per cent.
TEST(ForceSurrogate, PredictsEachPairFromTheOthersAsIfMadeWithoutIt) {
  const std::vector<ForcePair> pairs =
      pairs_of(forces_in_cone(15, 3), palpate::support::sticking_ball);
  const ForceSurrogate surrogate(pairs);
  double found = 0, expected = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    std::vector<ForcePair> others = pairs;
    others.erase(others.begin() + static_cast<std::ptrdiff_t>(i));
    const ForceSurrogate without(others);
    const PredictedDisplacement predicted = without.predict(pairs[i].force);
    const Matrix3d stiffness = surrogate.compliance(pairs[i].force).inverse();
    const Matrix3d covariance =
        predicted.covariance + without.noise() * without.noise() * Matrix3d::Identity();
    expected += (stiffness * covariance * stiffness).trace();
    found += (stiffness * (pairs[i].displacement - predicted.mean)).squaredNorm();
  }
  const auto count = static_cast<double>(pairs.size());
  EXPECT_NEAR(surrogate.left_out().expected, expected / count, 0.1 * expected / count);
  EXPECT_NEAR(surrogate.left_out().found, found / count, 0.1 * found / count);
}

TEST(ForceSurrogate, SeesThatDisplacementsComeFromNoEnergy) {
  const auto left_out = [](const auto& law) {
    return ForceSurrogate(pairs_of(forces_in_cone(25, 3), law)).left_out();
  };
  const LeftOutPairs elastic = left_out(foam), sticking = left_out(palpate::support::sticking_ball);
  EXPECT_LT(elastic.found, elastic.expected);
  EXPECT_LT(elastic.found, elastic.found_without_energy);
  EXPECT_GT(sticking.found, 3 * sticking.expected);
  EXPECT_GT(sticking.found, 3 * sticking.found_without_energy);
}

TEST(ForceSurrogate, ARigidContactIsNotBelievedToBeInfinitelyStiff) {
  const auto law = [](const Vector3d&) -> Vector3d { return Vector3d::Zero(); };
  const ForceSurrogate surrogate(pairs_of(forces_in_cone(10, 3), law));
  EXPECT_GT(surrogate.mean_compliance(), 0);
  const double error = surrogate.error_variance(forces_in_cone(5, 3));
  EXPECT_TRUE(std::isfinite(error));
  EXPECT_GT(error, 0);
}

TEST(ForceSurrogate, RefusesWhatIsNoMeasurement) {
  EXPECT_THROW(ForceSurrogate({}), InvalidInput);
  const ForcePair zero;
  EXPECT_THROW(ForceSurrogate({&zero, 1}), InvalidInput);
  const ForcePair broken{Vector3d(0, 0, 1),
                         Vector3d::Constant(std::numeric_limits<double>::quiet_NaN())};
  EXPECT_THROW(ForceSurrogate({&broken, 1}), InvalidInput);
  const ForcePair good{Vector3d(0, 0, 1), Vector3d(0, 0, 1)};
  EXPECT_THROW(ForceSurrogate({&good, 1}, {.position_noise = 0}), InvalidInput);
}

}  // namespace
}  // namespace palpate::probing
