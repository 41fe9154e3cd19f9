// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/transform_field.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "fit/convex_fit.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

// A is a rotation times a scale if A^T A / s^2 differs from the identity by at most this in each
// entry: the rounding of some operations.
constexpr double kSimilarity = 1e-12;
// Displacements at which a field is refitted: directions on concentric spheres within its reach.
constexpr int kSphereDirections = 48;
constexpr int kSpheres = 4;
// Accuracy of a refit relative to the root mean square force; far better than the measurement.
constexpr double kRefitAccuracy = 0.005;
// The reach is limited to where the force is this fraction of its asymptotic value. Further out it
// is nearly constant.
constexpr double kSaturation = 0.75;
// Distance, in extents of a field, at which its force is constant to a thousandth.
constexpr double kFarOut = 1e3;
constexpr int kBisections = 50;  // from kFarOut to 1e-12 of an extent

bool is_negative(const Multiquadric& base) { return base.weight < 0; }

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

double extent(const Multiquadric& base) { return base.center.norm() + base.epsilon; }

// Unit vectors, evenly spread; those of different spheres are staggered.
Eigen::Matrix3Xd directions(int sphere) {
  Eigen::Matrix3Xd result(3, kSphereDirections);
  for (int i = 0; i < kSphereDirections; ++i) {
    const double z = 1 - (2 * i + 1.0) / kSphereDirections;
    const double angle =
        2 * std::numbers::pi * std::numbers::phi * (i + sphere * kSphereDirections);
    const double across = std::sqrt(1 - z * z);
    result.col(i) << across * std::cos(angle), across * std::sin(angle), z;
  }
  return result;
}

// On spheres of evenly spaced radii, so that they are denser near zero, where each touch begins.
Eigen::Matrix3Xd displacements_within(double reach) {
  Eigen::Matrix3Xd result(3, kSpheres * kSphereDirections);
  for (int i = 0; i < kSpheres; ++i)
    result.middleCols(i * kSphereDirections, kSphereDirections) =
        reach * (i + 1) / kSpheres * directions(i);
  return result;
}

double root_mean_square(const Eigen::Matrix3Xd& columns) {
  return columns.norm() / std::sqrt(static_cast<double>(columns.cols()));
}

// [mm] Distance from zero within which a field with bases is refitted.
double refit_reach(const ForceField& field, const std::optional<double>& largest_force) {
  std::vector<double> extents;
  for (const Multiquadric& base : field.bases) extents.push_back(extent(base));
  if (!largest_force) return median(extents);
  const Eigen::Matrix3Xd sphere = directions(0);
  const auto force_at = [&](double radius) {
    Eigen::Matrix3Xd forces(3, sphere.cols());
    for (Eigen::Index i = 0; i < sphere.cols(); ++i)
      forces.col(i) = force(field, radius * sphere.col(i));
    return root_mean_square(forces);
  };
  double below = 0, above = kFarOut * *std::ranges::max_element(extents);
  const double wanted = std::min(*largest_force, kSaturation * force_at(above));
  for (int i = 0; i < kBisections; ++i) {
    const double middle = below + (above - below) / 2;
    (force_at(middle) < wanted ? below : above) = middle;
  }
  return kReachFactor * above;
}

// Fits bases to the given forces, without negative weights if `convex`. The samples are scaled
// because reach and forces may differ much from those of a measurement.
ForceField fit_bases(const Eigen::Matrix3Xd& displacements, const Eigen::Matrix3Xd& forces,
                     bool convex) {
  const double length = root_mean_square(displacements), newton = root_mean_square(forces);
  ForceField field;
  if (convex) {
    // `fit_force_field` may choose bases with negative weights if they fit better.
    field = fit_convex({displacements / length, forces / newton, {0, kRefitAccuracy / 2}},
                       kRefitAccuracy, kMaxConvexBases)
                .field;
  } else {
    field = fit_force_field(displacements / length, forces / newton,
                            {.mode = FitMode::certified,
                             .accuracy = kRefitAccuracy,
                             .noise = {.displacement = 0, .force = kRefitAccuracy / 2}})
                .field;
  }
  for (Multiquadric& base : field.bases) {
    base.weight *= newton;
    base.epsilon *= length;
    base.center *= length;
  }
  return rounded(std::move(field));
}

// Adds bases whose forces are those of `part`, transformed, within `result.reach`.
void refit(const ForceField& part, const Eigen::Matrix3d& A, double factor,
           TransformedField& result) {
  const Eigen::Matrix3Xd before = displacements_within(result.reach);
  const Eigen::Matrix3Xd after = A * before;
  const Eigen::Matrix3d to_force = factor * A.inverse().transpose();
  Eigen::Matrix3Xd forces(3, before.cols());
  for (Eigen::Index i = 0; i < before.cols(); ++i)
    forces.col(i) = to_force * force(part, before.col(i));
  const double rms = root_mean_square(forces);
  if (!std::isfinite(rms) || !(result.reach > 0) || !after.allFinite())
    throw SolverError("transform_field(): the forces of the transformed field overflow");
  if (rms == 0) return;
  const bool convex = std::ranges::none_of(part.bases, is_negative);
  const ForceField fit = fit_bases(after, forces, convex);
  for (Eigen::Index i = 0; i < before.cols(); ++i) forces.col(i) -= force(fit, after.col(i));
  result.rms = root_mean_square(forces);
  result.largest = forces.colwise().norm().maxCoeff();
  result.field.bases.insert(result.field.bases.end(), fit.bases.begin(), fit.bases.end());
}

}  // namespace

TransformedField transform_field(const ForceField& field, const Eigen::Matrix3d& A, double factor,
                                 std::optional<double> largest_force) {
  check_force_field(field, "transform_field(): the field");
  const double volume = A.determinant();
  if (!A.allFinite() || !(volume > 0) || !std::isfinite(volume)) {
    throw InvalidInput(
        "transform_field(): the map of displacements must be finite and keep volumes "
        "above zero; its determinant is " +
        std::to_string(volume));
  }
  require("transform_field(): factor", factor, above(0).finite());
  require("transform_field(): largest_force", largest_force, above(0).finite(), "N");
  const double scale = std::cbrt(volume);
  const bool is_similarity = (A.transpose() * A / (scale * scale)).isIdentity(kSimilarity);
  const Eigen::Matrix3d inverse = A.inverse();
  const bool has_negative = std::ranges::any_of(field.bases, is_negative);
  const bool has_isotropic = !std::ranges::all_of(field.bases, is_ridge);
  TransformedField result;
  ForceField to_refit;
  for (const Multiquadric& base : field.bases) {
    if (!is_similarity && has_isotropic && (!is_ridge(base) || has_negative)) {
      to_refit.bases.push_back(base);
    } else {
      result.field.bases.push_back(is_ridge(base) ? transformed_ridge(base, inverse, factor)
                                                  : scaled(base, A, scale, factor));
    }
  }
  if (!to_refit.bases.empty()) {
    result.exact = false;
    result.reach = refit_reach(field, largest_force);
    refit(to_refit, A, factor, result);
  }
  try {
    check_force_field(result.field, "transform_field(): the transformed field");
  } catch (const InvalidInput& overflow) {
    throw SolverError(overflow.what());
  }
  return result;
}

}  // namespace palpate::haptics
