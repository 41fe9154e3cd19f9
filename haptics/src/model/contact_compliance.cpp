// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/contact_compliance.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <algorithm>

#include "model/compliance_kriging.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "palpate/haptics/rotation.h"
#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

// Newton's method has converged when the relative error of the force is at most this: far above
// rounding, far below the accuracy of measurements.
constexpr double kForceTolerance = 1e-9;
constexpr int kMaxNewtonIterations = 100;  // of Newton's method; convex fields take about ten
constexpr double kSufficientDecrease = 1e-4;
constexpr double kShortestStep = 1e-9;
// A stiffness counts as positive definite with eigenvalues above this times its norm.
constexpr double kPositiveDefinite = 1e-9;
constexpr int kDirectionPlaces = 10;  // keeps `kFrameTolerance`

// Minimises the energy minus the work of `load`, starting from zero; nullopt if no minimum is found
// within `limit`.
std::optional<Eigen::Vector3d> displacement_under(const ForceField& field,
                                                  const Eigen::Vector3d& load, double limit) {
  Eigen::Vector3d x = Eigen::Vector3d::Zero();
  const auto energy = [&](const Eigen::Vector3d& at) {
    return potential(field, at) - load.dot(at);
  };
  for (int i = 0; i < kMaxNewtonIterations; ++i) {
    const Eigen::Vector3d gradient = force(field, x) - load;
    if (gradient.norm() <= kForceTolerance * load.norm()) return x;
    const Eigen::Matrix3d hessian = stiffness(field, x);
    // If the energy is not convex, take a gradient step.
    Eigen::LLT<Eigen::Matrix3d> factor(hessian + kPositiveDefinite * hessian.norm() *
                                                     Eigen::Matrix3d::Identity());
    Eigen::Vector3d step = -gradient / std::max(hessian.norm(), load.norm() / limit);
    if (factor.info() == Eigen::Success && hessian.norm() > 0) step = -factor.solve(gradient);
    if (step.norm() > limit / 2) step *= limit / 2 / step.norm();
    // Near the minimum rounding hides the decrease of the energy; accept a smaller force error
    // instead.
    double length = 1;
    const auto improves = [&](const Eigen::Vector3d& next) {
      return energy(next) <= energy(x) + kSufficientDecrease * length * gradient.dot(step) ||
             (force(field, next) - load).norm() <= gradient.norm() / 2;
    };
    while (length > kShortestStep && !improves(x + length * step)) length /= 2;
    x += length * step;
    if (!(x.norm() <= limit) || length <= kShortestStep) return std::nullopt;
  }
  return std::nullopt;
}

// For each contact, the mean inward normal of the surface in the world frame, weighted with the
// contact's weights; the z axis of its frame if all weights are zero.
std::vector<Eigen::Vector3d> inward_normals(const Model& model) {
  const geometry::SurfaceWeights weights = vertex_weights(model);
  std::vector<Eigen::Vector3d> sums(model.contacts.size(), Eigen::Vector3d::Zero());
  for (const auto& corners : model.surface.triangles.colwise()) {
    const Eigen::Vector3d a = model.surface.vertices.col(corners[0]);
    const Eigen::Vector3d area = (model.surface.vertices.col(corners[1]) - a)
                                     .cross(model.surface.vertices.col(corners[2]) - a);
    for (const int corner : corners) {
      for (int k = 0; k < 3; ++k) {
        const int contact = weights.contacts(k, corner);
        if (contact >= 0)
          sums[static_cast<std::size_t>(contact)] -= weights.weights(k, corner) * area;
      }
    }
  }
  for (std::size_t i = 0; i < sums.size(); ++i) {
    sums[i] = sums[i].norm() > 0 ? Eigen::Vector3d(sums[i].normalized())
                                 : Eigen::Vector3d(model.contacts[i].frame.col(2));
  }
  return sums;
}

// `direction` in the frame of the field.
std::optional<ContactCompliance> measure(const ForceField& local_field,
                                         const Eigen::Vector3d& direction, double reference_force,
                                         double limit) {
  const Eigen::Matrix3d from_pressing = rotation_between(Eigen::Vector3d::UnitZ(), direction);
  const ForceField field = rotated(local_field, from_pressing.transpose());
  const std::optional<Eigen::Vector3d> displacement =
      displacement_under(field, {0, 0, reference_force}, limit);
  if (!displacement || !(displacement->z() > 0)) return std::nullopt;
  const Eigen::Matrix3d there = stiffness(field, *displacement);
  if (Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(there, Eigen::EigenvaluesOnly)
          .eigenvalues()(0) <= kPositiveDefinite * there.norm()) {
    return std::nullopt;
  }
  const Eigen::Matrix2d across = there.topLeftCorner<2, 2>().inverse();
  ContactCompliance result;
  result.direction =
      direction.unaryExpr([](double x) { return round_to_places(x, kDirectionPlaces); });
  result.values << *displacement, across(0, 0), (across(0, 1) + across(1, 0)) / 2, across(1, 1);
  result.values =
      result.values.unaryExpr([](double x) { return round_to_digits(x, kFieldDigits); });
  return result;
}

}  // namespace

Model with_compliances(Model model, double reference_force) {
  require("with_compliances(): reference_force", reference_force, above(0).finite(), "N");
  check_model(model);
  const double limit = geometry::bounding_diagonal(model.surface);
  const std::vector<Eigen::Vector3d> normals = inward_normals(model);
  parallel_for(model.contacts.size(), [&](std::size_t i) {
    ContactModel& contact = model.contacts[i];
    const Eigen::Vector3d direction = (contact.frame.transpose() * normals[i]).normalized();
    contact.compliance = measure(contact.field, direction, reference_force, limit);
    contact.strength.reset();
  });
  model.interpolation = {.rule = BlendRule::compliances, .reference_force = reference_force};

  const ComplianceKriging kriging = learn_kriging(model);
  model.interpolation.reach = kReachRatio * kriging.spacing;
  parallel_for(kriging.known.size(), [&](std::size_t i) {
    ContactModel& contact = model.contacts[static_cast<std::size_t>(kriging.known[i])];
    contact.compliance->trend =
        kriging_trend(kriging.around[i], contact.compliance->values, kriging.covariance)
            .unaryExpr([](double value) { return round_to_digits(value, kTrendDigits); });
  });
  return model;
}

}  // namespace palpate::haptics
