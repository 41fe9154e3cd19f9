// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/force_field.h"

#include <cmath>
#include <string>

#include "field/field_forces.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::haptics {
namespace {

// P d
Eigen::Vector3d seen(const Multiquadric& base, const Eigen::Vector3d& d) noexcept {
  return is_ridge(base) ? Eigen::Vector3d(base.ridge.dot(d) * base.ridge) : d;
}

double rounded_length(const Multiquadric& base, const Eigen::Vector3d& seen) noexcept {
  return std::sqrt(seen.squaredNorm() + base.epsilon * base.epsilon);
}

}  // namespace

void check_force_field(const ForceField& field, const char* what) {
  for (std::size_t k = 0; k < field.bases.size(); ++k) {
    const Multiquadric& base = field.bases[k];
    const std::string name = std::string(what) + ": base " + std::to_string(k);
    if (!base.center.allFinite() || !base.ridge.allFinite() || !std::isfinite(base.weight)) {
      throw InvalidInput(name + " is not finite");
    }
    require([&] { return name + ": epsilon"; }, base.epsilon, above(0).finite(), "mm");
    if (is_ridge(base) && !(std::abs(base.ridge.norm() - 1) <= kRidgeTolerance)) {
      throw InvalidInput(name + ": the length of its ridge is " +
                         std::to_string(base.ridge.norm()) + "; it must be 1, or 0 for none");
    }
  }
}

ForceField rotated(ForceField field, const Eigen::Matrix3d& rotation) {
  for (Multiquadric& base : field.bases) {
    base.center = rotation * base.center;
    if (is_ridge(base)) base.ridge = (rotation * base.ridge).normalized();
  }
  return field;
}

double potential(const ForceField& field, const Eigen::Vector3d& displacement) noexcept {
  double result = 0;
  for (const Multiquadric& base : field.bases) {
    const Eigen::Vector3d center = seen(base, base.center), x = seen(base, displacement);
    const double at_zero = rounded_length(base, center);
    const double here = rounded_length(base, x - center);
    // s(x) - s(0) = (s(x)^2 - s(0)^2) / (s(x) + s(0)), which does not cancel for small
    // displacements.
    const double difference = x.dot(x - 2 * center) / (here + at_zero);
    result += base.weight * (difference + center.dot(x) / at_zero);
  }
  return result;
}

Eigen::Vector3d force(const ForceField& field, const Eigen::Vector3d& displacement) noexcept {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  for (const Multiquadric& base : field.bases) {
    const Eigen::Vector3d center = seen(base, base.center);
    const Eigen::Vector3d d = seen(base, displacement) - center;
    result += base.weight * (d / rounded_length(base, d) + center / rounded_length(base, center));
  }
  return result;
}

Eigen::Matrix3Xd field_forces(const ForceField& field, const Eigen::Matrix3Xd& displacements) {
  Eigen::Matrix3Xd result = Eigen::Matrix3Xd::Zero(3, displacements.cols());
  for (const Multiquadric& base : field.bases) {
    const Eigen::Vector3d center = seen(base, base.center);
    const Eigen::Vector3d at_zero = center / rounded_length(base, center);
    for (Eigen::Index i = 0; i < displacements.cols(); ++i) {
      const Eigen::Vector3d d = seen(base, displacements.col(i)) - center;
      result.col(i) += base.weight * (d / rounded_length(base, d) + at_zero);
    }
  }
  return result;
}

Eigen::Matrix3d stiffness(const ForceField& field, const Eigen::Vector3d& displacement) noexcept {
  Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
  for (const Multiquadric& base : field.bases) {
    const Eigen::Vector3d d = seen(base, displacement - base.center);
    const double s = rounded_length(base, d);
    const Eigen::Vector3d q = d / s;
    Eigen::Matrix3d projection = Eigen::Matrix3d::Identity();
    if (is_ridge(base)) projection = base.ridge * base.ridge.transpose();
    result += base.weight / s * (projection - q * q.transpose());
  }
  return result;
}

}  // namespace palpate::haptics
