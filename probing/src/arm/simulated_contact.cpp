// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "arm/simulated_contact.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>

namespace palpate::probing {

SimulatedContact::SimulatedContact(const Specimen& specimen, double structure)
    : specimen_(specimen),
      query_(specimen.surface()),
      normals_(geometry::vertex_normals(specimen.surface())),
      structure_(structure),
      retardation_(specimen.retardation()),
      prompt_(1 - retardation_.share) {}

void SimulatedContact::find_surface(const Eigen::Vector3d& tip, std::uint64_t tick) {
  tick_ = tick;
  const Eigen::Vector3d p = touches_ ? place_ : tip;
  constexpr double kNear = 3;  // [mm] the tip moves less than this in one tick
  const geometry::ClosestPoint closest = query_.closest_point(p);
  const geometry::TriangleMesh& mesh = specimen_.surface();
  surface_normal_.setZero();
  for (int corner = 0; corner < 3; ++corner) {
    surface_normal_ +=
        closest.at.barycentric[corner] * normals_.col(mesh.triangles(corner, closest.at.triangle));
  }
  surface_normal_.normalize();
  surface_point_ = closest.position;
  const Eigen::Vector3d offset = p - surface_point_;
  // Beyond the border the closest point is not below the tip.
  const double beside = (offset - offset.dot(surface_normal_) * surface_normal_).norm();
  if (!touches_) {
    near_ = closest.distance < kNear && beside < 0.5;
  } else if (beside > 0.5) {
    leave();
  } else if ((surface_point_ - cone_place_).norm() > 0.05) {
    place_ = surface_point_;
    cone_ = specimen_.friction_cone(place_);
    cone_place_ = place_;
    refresh_at(reference_);
  }
}

std::optional<Eigen::Vector3d> SimulatedContact::press(const Eigen::Vector3d& tip) {
  if (!touches_) {
    if (!near_ || (tip - surface_point_).dot(surface_normal_) > 0) return std::nullopt;
    touch(tip);
  }
  Eigen::Vector3d pressed = softness_inverse_ * strain(tip);
  const double along = pressed.dot(cone_.axis);
  if (along <= 0) {
    // The retarded part keeps the surface below its place for a while; the tip may leave it, and
    // touch it again.
    const bool inside = (tip - surface_point_).dot(surface_normal_) < 0;
    touches_ = inside && !late_.isZero(0);
    if (!touches_) near_ = false;
    elastic_.setZero();
    return std::nullopt;
  }
  const Eigen::Vector3d tangential = pressed - along * cone_.axis;
  if (tangential.norm() > cone_.coefficient * along) {
    const std::optional<Eigen::Vector3d> on_cone = slide(tip, tangential);
    if (!on_cone) return std::nullopt;
    pressed = *on_cone;
  }
  elastic_ = pressed;
  return pressed;
}

/// [mm] The strain that the tip's place demands of the force: `softness_` times the force.
Eigen::Vector3d SimulatedContact::strain(const Eigen::Vector3d& tip) const {
  return tip - place_ - late_ - prompt_ * displacement_ + prompt_ * slope_ * reference_;
}

/// Moves the contact along the surface until the force is on the cone.
std::optional<Eigen::Vector3d> SimulatedContact::slide(const Eigen::Vector3d& tip,
                                                       const Eigen::Vector3d& tangential) {
  const Eigen::Vector3d on_cone = cone_.axis + cone_.coefficient * tangential.normalized();
  const Eigen::Vector3d first = surface_normal_.unitOrthogonal();
  Eigen::Matrix3d system;
  system << softness_ * on_cone, first, surface_normal_.cross(first);
  const Eigen::Vector3d solution = system.lu().solve(strain(tip));
  if (!(solution[0] > 0)) {
    leave();
    return std::nullopt;
  }
  const Eigen::Vector3d way = system.rightCols<2>() * solution.tail<2>();
  place_ += way;
  slid_ += way.norm();
  return solution[0] * on_cone;
}

void SimulatedContact::touch(const Eigen::Vector3d& tip) {
  constexpr double kForce = 0.05;  // [N] of the differences
  touches_ = true;
  slid_ = 0;
  place_ = tip - (tip - surface_point_).dot(surface_normal_) * surface_normal_;
  cone_ = specimen_.friction_cone(place_);
  cone_place_ = place_;
  Eigen::Matrix3d forces, places;
  const Eigen::Vector3d side = cone_.axis.unitOrthogonal();
  forces << kForce * cone_.axis, kForce * (cone_.axis + 0.3 * side),
      kForce * (cone_.axis + 0.3 * cone_.axis.cross(side));
  for (int i = 0; i < 3; ++i) places.col(i) = specimen_.displacement(place_, forces.col(i));
  slope_ = places * forces.inverse();
  reference_.setZero();
  displacement_.setZero();
  elastic_.setZero();
  late_.setZero();
  tick_of_reference_ = tick_;
  soften();
}

void SimulatedContact::settle(double period) {
  if (!touches_) return;
  refresh();
  creep(period);
}

void SimulatedContact::refresh() {
  constexpr double kLeast = 0.03, kRelative = 0.05;  // [N], relative to the force
  constexpr std::uint64_t kLongest = 50;             // ticks
  constexpr double kUnchanged = 1e-4;                // [N]
  const double change = (elastic_ - reference_).norm();
  const bool old = tick_ - tick_of_reference_ > kLongest && change > kUnchanged;
  if (change > kLeast + kRelative * reference_.norm() || old) refresh_at(elastic_);
}

void SimulatedContact::refresh_at(const Eigen::Vector3d& force) {
  const Eigen::Vector3d computed = specimen_.displacement(place_, force);
  const Eigen::Vector3d change = force - reference_;
  constexpr double kShowsSlope = 1e-3;  // [N]
  if (change.norm() > kShowsSlope) {
    // Powell's symmetric update: an elastic object's compliance is symmetric.
    const double square = change.squaredNorm();
    const Eigen::Vector3d error = computed - displacement_ - slope_ * change;
    slope_ += (error * change.transpose() + change * error.transpose()) / square -
              change.dot(error) / (square * square) * change * change.transpose();
  }
  reference_ = force;
  displacement_ = computed;
  tick_of_reference_ = tick_;
  soften();
}

/// The retarded part of the displacement approaches its share of the equilibrium.
void SimulatedContact::creep(double period) {
  if (retardation_.share == 0) return;
  const Eigen::Vector3d equilibrium = displacement_ + slope_ * (elastic_ - reference_);
  late_ += (1 - std::exp(-period / retardation_.time)) * (retardation_.share * equilibrium - late_);
}

void SimulatedContact::soften() {
  // Remove negative compliances. Updates along a few directions can cause them in others where the
  // object stiffens quickly, as beside a support; the forces would then grow without bound.
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen((slope_ + slope_.transpose()) / 2);
  slope_ = eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0).asDiagonal() *
           eigen.eigenvectors().transpose();
  softness_ = prompt_ * slope_ + Eigen::Matrix3d::Identity() / structure_;
  softness_inverse_ = softness_.inverse();
}

}  // namespace palpate::probing
