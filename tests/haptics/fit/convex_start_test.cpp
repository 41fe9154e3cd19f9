// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/convex_start.h"

#include <gtest/gtest.h>

#include <cmath>

#include "haptics_testing.h"
#include "palpate/haptics/realignment.h"
#include "strip_acquisition.h"

namespace palpate::haptics {
namespace {

constexpr SampleNoise kSampleNoise{0.003, 0.01};

// A contact of a sheet, in units of its extents.
ForceSamples contact() {
  const probing::Acquisition acquisition = support::strip_contact(-28, 40);
  ForceSamples samples = realign(acquisition.contacts.front(), acquisition.samples);
  samples.displacements /= std::sqrt(samples.displacements.colwise().squaredNorm().mean());
  samples.forces /= std::sqrt(samples.forces.colwise().squaredNorm().mean());
  return samples;
}

TEST(ConvexStart, DoesNotDependOnTheFrame) {
  // Even and odd numbers: the direction of an axis, which nothing tells, must not decide where one
  // half of the samples ends.
  const ForceSamples samples = contact();
  for (Eigen::Index count = 60; count <= 110; count += 5) {
    const Eigen::Matrix3Xd places = samples.displacements.leftCols(count),
                           forces = samples.forces.leftCols(count);
    const ForceField start = convex_start(WhitenedProblem(places, forces, kSampleNoise), 14);
    const Eigen::Matrix3Xd at_places = forces_at(start, places);
    Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
    for (int i = 0; i < 3; ++i) {
      turn = turn * some_rotation();
      const ForceField other =
          convex_start(WhitenedProblem(turn * places, turn * forces, kSampleNoise), 14);
      const Eigen::Matrix3Xd turned = turn.transpose() * forces_at(other, turn * places);
      EXPECT_LT((turned - at_places).norm(), 1e-9 * at_places.norm()) << count;
    }
  }
}

TEST(ConvexStart, HasNoMoreBasesThanItMayAndNoneThatPulls) {
  const ForceSamples samples = contact();
  const WhitenedProblem problem(samples.displacements, samples.forces, kSampleNoise);
  double error = problem.residuals({}).squaredNorm();
  for (const int most : {1, 3, 8, 14}) {
    const ForceField start = convex_start(problem, most);
    EXPECT_LE(start.bases.size(), static_cast<std::size_t>(most));
    for (const Multiquadric& base : start.bases) EXPECT_GT(base.weight, 0);
    const double fewer = error;
    error = problem.residuals(start).squaredNorm();
    EXPECT_LT(error, 0.7 * fewer) << most;
  }
}

}  // namespace
}  // namespace palpate::haptics
