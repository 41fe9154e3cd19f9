// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/transform_field.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "palpate/error.h"
#include "palpate/haptics/force_field_fit.h"

namespace palpate::haptics {
namespace {

// A is a rotation times a scale iff no entry of A^T A / s^2 is further from the identity than this:
// rounding of some operations.
constexpr double kSimilarity = 1e-12;
// Displacements to refit a field at: directions on some spheres within its reach.
constexpr int kDirections = 48;
constexpr int kSpheres = 4;
// Of the root mean square force: how well a field is refitted, far better than it was measured.
constexpr double kRefitAccuracy = 0.005;
constexpr int kRefitBases = 8;

bool is_ridge(const Multiquadric& base) { return base.ridge != Eigen::Vector3d::Zero(); }

// w sqrt((r.(A^-1 x - c))^2 + e^2), with q = A^-T r, is w |q| sqrt((q.x - r.c)^2 + e^2) / |q|.
Multiquadric transformed_ridge(const Multiquadric& base, const Eigen::Matrix3d& inverse,
                               double factor) {
  const Eigen::Vector3d q = inverse.transpose() * base.ridge;
  const double length = q.norm();
  return {.weight = factor * base.weight * length,
          .epsilon = base.epsilon / length,
          .center = base.ridge.dot(base.center) / length * (q / length),
          .ridge = (q / length).normalized()};
}

Multiquadric scaled(const Multiquadric& base, const Eigen::Matrix3d& A, double scale,
                    double factor) {
  return {.weight = factor * base.weight / scale,
          .epsilon = base.epsilon * scale,
          .center = A * base.center};
}

// Evenly spread in the ball.
Eigen::Matrix3Xd displacements_within(double reach) {
  Eigen::Matrix3Xd result(3, kSpheres * kDirections);
  for (int i = 0; i < kSpheres * kDirections; ++i) {
    const double z = 1 - (2 * (i % kDirections) + 1.0) / kDirections;
    const double angle = 2 * std::numbers::pi * std::numbers::phi * i;
    const double across = std::sqrt(1 - z * z);
    const int sphere = 1 + i / kDirections;
    const double radius = reach * sphere / kSpheres;
    result.col(i) << radius * across * std::cos(angle), radius * across * std::sin(angle),
        radius * z;
  }
  return result;
}

// Adds bases whose forces are those of `part`, transformed.
void refit(const ForceField& part, const Eigen::Matrix3d& A, double factor,
           TransformedField& result) {
  result.exact = false;
  for (const Multiquadric& base : part.bases)
    result.reach = std::max(result.reach, base.center.norm() + base.epsilon);
  const Eigen::Matrix3Xd before = displacements_within(result.reach);
  const Eigen::Matrix3d inverse = A.inverse();
  Eigen::Matrix3Xd forces(3, before.cols());
  for (Eigen::Index i = 0; i < before.cols(); ++i)
    forces.col(i) = factor * inverse.transpose() * force(part, before.col(i));
  const double rms = forces.norm() / std::sqrt(static_cast<double>(forces.cols()));
  if (!(rms > 0)) return;
  const FitResult fit = fit_force_field(
      A * before, forces,
      {.mode = FitMode::local, .accuracy = kRefitAccuracy * rms, .max_bases = kRefitBases});
  for (Eigen::Index i = 0; i < before.cols(); ++i) {
    const double error = (force(fit.field, A * before.col(i)) - forces.col(i)).norm();
    result.rms += error * error / static_cast<double>(before.cols());
    result.largest = std::max(result.largest, error);
  }
  result.rms = std::sqrt(result.rms);
  result.field.bases.insert(result.field.bases.end(), fit.field.bases.begin(),
                            fit.field.bases.end());
}

}  // namespace

TransformedField transform_field(const ForceField& field, const Eigen::Matrix3d& A, double factor) {
  check_force_field(field, "transform_field(): the field");
  const double volume = A.determinant();
  if (!A.allFinite() || !(volume > 0) || !std::isfinite(volume)) {
    throw InvalidInput(
        "transform_field(): the map of displacements must be finite and keep volumes "
        "above zero; its determinant is " +
        std::to_string(volume));
  }
  if (!(factor > 0) || !std::isfinite(factor)) {
    throw InvalidInput("transform_field(): the factor is " + std::to_string(factor) +
                       "; it must be finite and > 0");
  }
  const double scale = std::cbrt(volume);
  const bool is_similarity = (A.transpose() * A / (scale * scale)).isIdentity(kSimilarity);
  const Eigen::Matrix3d inverse = A.inverse();
  const bool has_negative = std::ranges::any_of(
      field.bases, [](const Multiquadric& base) { return !is_ridge(base) && base.weight < 0; });
  TransformedField result;
  ForceField to_refit;
  for (const Multiquadric& base : field.bases) {
    if (!is_similarity && (!is_ridge(base) || has_negative)) {
      to_refit.bases.push_back(base);
    } else {
      result.field.bases.push_back(is_ridge(base) ? transformed_ridge(base, inverse, factor)
                                                  : scaled(base, A, scale, factor));
    }
  }
  if (!to_refit.bases.empty()) refit(to_refit, A, factor, result);
  try {
    check_force_field(result.field, "transform_field(): the transformed field");
  } catch (const InvalidInput& overflow) {
    throw SolverError(overflow.what());
  }
  return result;
}

}  // namespace palpate::haptics
