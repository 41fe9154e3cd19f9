// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "field/energy_bound.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "field/mixed_field.h"
#include "haptics_testing.h"

namespace palpate::haptics {
namespace {

// A grid that has the corners and the middle.
template <typename Visit>
void visit_places(const Cell& cell, Visit&& visit) {
  constexpr int kHalf = 3;
  for (int i = -kHalf; i <= kHalf; ++i) {
    for (int j = -kHalf; j <= kHalf; ++j) {
      for (int k = -kHalf; k <= kHalf; ++k) {
        visit(Eigen::Vector3d(cell.center + cell.half_width / kHalf * Eigen::Vector3d(i, j, k)));
      }
    }
  }
}

TEST(EnergyBound, IsBelowTheEnergyInTheCell) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    const ForceField field = mixed_field(6, seed);
    const EnergyBound bound(field, 10, 0);
    for (const double half_width : {3.0, 0.4, 0.01}) {
      const Cell cell{random_points(1, 7, seed + 1).col(0), half_width};
      const EnergyBound::InCell found = bound.in_cell(cell);
      visit_places(cell, [&](const Eigen::Vector3d& place) {
        EXPECT_LE(found.lowest, potential(field, place)) << seed << ' ' << half_width;
      });
      EXPECT_NEAR(found.at_center.value, potential(field, cell.center), 1e-12);
    }
  }
}

TEST(EnergyBound, KnowsHowConcaveANegativeBaseIs) {
  const Eigen::Vector3d tip(1.1, -2.3, 0.7);
  const ForceField field{{{-1, 0.5, tip}}};
  for (const double half_width : {0.05, 0.5, 2.0}) {
    const Cell cell{tip, half_width};
    const double lowest = EnergyBound(field, 10, 0).in_cell(cell).lowest;
    visit_places(cell, [&](const Eigen::Vector3d& place) {
      EXPECT_LE(lowest, potential(field, place)) << half_width;
    });
  }
}

TEST(EnergyBound, MissesTheLowestEnergyByLessThanTheSquareOfTheCell) {
  // With the exact slope, what is lost comes from curvature: a fourth with each halving.
  const ForceField field = mixed_field(6, 5);
  const EnergyBound bound(field, 10, 0);
  double coarser = 0;
  for (double half_width = 0.5; half_width > 0.01; half_width /= 2) {
    const Cell cell{{2, -3.3, 1.7}, half_width};
    double lowest = potential(field, cell.center);
    visit_places(cell, [&](const Eigen::Vector3d& place) {
      lowest = std::min(lowest, potential(field, place));
    });
    const double lost = lowest - bound.in_cell(cell).lowest;
    if (coarser > 0) {
      EXPECT_LT(lost, 0.3 * coarser) << half_width;
    }
    coarser = lost;
  }
}

TEST(EnergyBound, IsCloseWhereTheThirdDerivativeIsLargest) {
  // A base whose energy falls most towards a corner of the cell, where along the same direction the
  // third derivative is at its extreme: d / s = 1 / sqrt(3), third derivative -2 / sqrt(3) / s^2.
  const Eigen::Vector3d diagonal = Eigen::Vector3d::Ones() / std::sqrt(3.0);
  const ForceField field{{{1, 1, -5 * diagonal}}};
  const Cell cell{(-5 + std::sqrt(0.5)) * diagonal, 0.03};
  const double reach = std::sqrt(3.0) * cell.half_width, s_squared = 1.5;
  const double cubic = 2 / std::sqrt(3.0) / s_squared * std::pow(reach, 3) / 6;
  const double corner = potential(field, cell.center + reach * diagonal);
  const double lowest = EnergyBound(field, 10, 0).in_cell(cell).lowest;
  EXPECT_LE(lowest, corner);
  EXPECT_GT(lowest, corner - 0.5 * cubic);
}

TEST(EnergyBound, HasNoNegativeEnergyInTheSafeBall) {
  int safe = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    const ForceField field = mixed_field(6, seed);
    const double radius = EnergyBound(field, 10, 0).safe_radius();
    const double smallest =
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(stiffness(field, Eigen::Vector3d::Zero()))
            .eigenvalues()[0];
    EXPECT_EQ(radius > 0, smallest > 1e-9) << seed;
    if (radius > 0) ++safe;
    const Eigen::Matrix3Xd places = random_points(500, radius, seed);
    for (const auto& place : places.colwise()) {
      EXPECT_GE(potential(field, place), 0) << seed;
    }
  }
  EXPECT_GT(safe, 20);
  EXPECT_LT(safe, 60);
}

TEST(EnergyBound, MarginCoversChangesOfAllNumbers) {
  constexpr double kTolerance = 1e-3;
  for (unsigned seed = 0; seed < 30; ++seed) {
    const ForceField field = mixed_field(4, seed);
    const double margin = EnergyBound(field, 10, kTolerance).margin();
    const ForceField changed = with_changed_numbers(field, kTolerance, seed);
    const Eigen::Matrix3Xd places = random_points(50, 10, seed);
    for (const auto& place : places.colwise()) {
      const Eigen::Matrix3d change = stiffness(changed, place) - stiffness(field, place);
      EXPECT_LE(Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(change)
                    .eigenvalues()
                    .cwiseAbs()
                    .maxCoeff(),
                margin);
    }
  }
}

}  // namespace
}  // namespace palpate::haptics
