// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <random>

#include "palpate/haptics/force_field.h"
#include "refusal.h"
#include "scratch_folder.h"

namespace palpate::haptics {

/// Of central differences of functions of order 1 to 10, and how exact those are.
inline constexpr double kDifferenceStep = 1e-5;
inline constexpr double kDifferenceTolerance = 1e-7;

/// Points in a ball, the same on every run.
inline Eigen::Matrix3Xd random_points(Eigen::Index count, double radius, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index i = 0; i < count;) {
    const Eigen::Vector3d point{uniform(random), uniform(random), uniform(random)};
    if (point.norm() <= 1) points.col(i++) = radius * point;
  }
  return points;
}

/// A rotation without symmetry.
inline Eigen::Matrix3d some_rotation() {
  return Eigen::AngleAxisd(2.1, Eigen::Vector3d(0.3, -0.7, 0.5).normalized()).toRotationMatrix();
}

/// An isotropic base around zero: a softening spring.
inline ForceField spring(double weight, double epsilon) { return {{{weight, epsilon}}}; }

/// p(r) = sqrt(r^2 + 1) - 1 - 1.5 (sqrt(r^2 + 9) - 3): a valley around zero, and negative beyond
/// the radius where both roots are equal.
inline ForceField valley() { return {{{1, 1}, {-1.5, 3}}}; }

/// The same field in other units of force and length.
inline ForceField scaled(ForceField field, double force, double length = 1) {
  for (Multiquadric& base : field.bases) {
    base.weight *= force;
    base.epsilon *= length;
    base.center *= length;
  }
  return field;
}

/// A field of three isotropic bases, awkward numbers, stable at zero.
inline ForceField some_field() {
  return {{{1.7, 3.1, {0.4, -1.3, 2.7}},  //
           {2.3, 3.1, {-2.2, 0.9, -0.6}},
           {-0.4, 3.1, {1.1, 3.3, -1.9}}}};
}

/// The same with a ridge across all axes.
inline ForceField some_field_with_ridge() {
  ForceField field = some_field();
  field.bases.push_back({0.9, 1.7, {0.3, 0.2, 1.9}, Eigen::Vector3d(0.4, -0.5, 0.8).normalized()});
  return field;
}

/// Bound of |force| everywhere.
inline double weight_sum(const ForceField& field) {
  double sum = 0;
  for (const Multiquadric& base : field.bases) sum += std::abs(base.weight);
  return sum;
}

/// [N/mm] at zero, in the softest direction.
inline double stiffness_at_zero(const ForceField& field) {
  return Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(stiffness(field, Eigen::Vector3d::Zero()))
      .eigenvalues()[0];
}

inline Eigen::Matrix3Xd forces_at(const ForceField& field, const Eigen::Matrix3Xd& displacements) {
  Eigen::Matrix3Xd forces(3, displacements.cols());
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    forces.col(i) = force(field, displacements.col(i));
  }
  return forces;
}

}  // namespace palpate::haptics
