// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <numbers>
#include <random>
#include <string>

#include "palpate/error.h"
#include "palpate/haptics/force_field.h"
#include "scratch_folder.h"

namespace palpate::haptics {

/// The message of the InvalidInput (or FileError) that `call` throws.
template <typename Call>
std::string refusal(Call&& call) {
  try {
    static_cast<void>(call());
  } catch (const InvalidInput& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was refused";
  return {};
}

/// Points in a ball, the same on every run.
inline Eigen::Matrix3Xd random_points(Eigen::Index count, double radius, unsigned seed = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Eigen::Matrix3Xd points(3, count);
  for (Eigen::Index i = 0; i < count;) {
    const Eigen::Vector3d point(uniform(random), uniform(random), uniform(random));
    if (point.norm() <= 1) points.col(i++) = radius * point;
  }
  return points;
}

/// A rotation without symmetry.
inline Eigen::Matrix3d some_rotation() {
  return Eigen::AngleAxisd(2.1, Eigen::Vector3d(0.3, -0.7, 0.5).normalized()).toRotationMatrix();
}

/// A field of three bases, awkward numbers, stable at zero.
inline ForceField some_field() {
  ForceField field{Eigen::Matrix3Xd(3, 3), Eigen::Vector3d(1.7, 2.3, -0.4), 3.1};
  field.centers << 0.4, -2.2, 1.1, -1.3, 0.9, 3.3, 2.7, -0.6, -1.9;
  return field;
}

inline Eigen::Matrix3Xd forces_at(const ForceField& field, const Eigen::Matrix3Xd& displacements) {
  Eigen::Matrix3Xd forces(3, displacements.cols());
  for (Eigen::Index i = 0; i < forces.cols(); ++i) {
    forces.col(i) = force(field, displacements.col(i));
  }
  return forces;
}

}  // namespace palpate::haptics
