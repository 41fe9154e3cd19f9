// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/tip_contact.h"

#include <algorithm>
#include <cmath>

namespace palpate::probing {
namespace {

struct Entry {
  Eigen::Vector3d anchor;      // unit length
  Eigen::Matrix3d derivative;  // [1/mm] by the point's position
};

// Finds where the line from `start`, outside, to `point`, inside, enters the ball.
Entry entry_into_ball(double radius, const Eigen::Vector3d& start, const Eigen::Vector3d& point) {
  const Eigen::Vector3d way = point - start;
  const double a = way.squaredNorm(), b = start.dot(way);
  const double c = start.squaredNorm() - radius * radius;
  const double root = std::sqrt(std::max(b * b - a * c, 0.0));
  // The smaller solution of a s^2 + 2 b s + c = 0, without cancellation: b < 0 < c.
  const double part = std::clamp(c / (root - b), 0.0, 1.0);
  const Eigen::Vector3d at = (start + part * way) / radius;
  const double speed = at.dot(way);
  // A path that only grazes the ball has no derivative; its anchor is kept then.
  constexpr double kGrazing = 1e-3;  // cosine of the angle between the path and the normal
  if (!(speed < -kGrazing * way.norm())) return {at, Eigen::Matrix3d::Zero()};
  return {at, part / radius * (Eigen::Matrix3d::Identity() - way * at.transpose() / speed)};
}

}  // namespace

std::optional<TipTraction> tip_traction(const TipLaw& law, const Eigen::Vector3d& point,
                                        const Eigen::Vector3d& start,
                                        const std::optional<Eigen::Vector3d>& anchor) {
  const double distance = point.norm();
  if (!(distance < law.radius) || distance == 0) return std::nullopt;
  const Eigen::Matrix3d identity = Eigen::Matrix3d::Identity();
  const Eigen::Vector3d n = point / distance;
  const Eigen::Matrix3d across = identity - n * n.transpose();
  const double depth = law.radius - distance;
  const double pressure = law.normal_stiffness * depth;

  TipTraction result;
  result.traction = pressure * n;
  result.tangent = -law.normal_stiffness * n * n.transpose() + pressure / distance * across;
  result.energy = pressure * depth / 2;
  result.anchor = n;
  if (law.friction == 0 || law.tangential_stiffness == 0) return result;

  Entry entry{n, Eigen::Matrix3d::Zero()};
  const double began = start.norm();
  if (anchor) {
    entry.anchor = *anchor;
  } else if (began > law.radius) {
    entry = entry_into_ball(law.radius, start, point);
  } else if (began > 0) {
    // It sticks where it was: the same as if it had been just outside, as a point that the tip
    // touches may be by rounding.
    entry.anchor = start / began;
  }
  const Eigen::Vector3d& a = entry.anchor;
  const double stiffness = law.tangential_stiffness * law.radius * law.radius;
  const double along = n.dot(a);
  const Eigen::Vector3d trial = stiffness / distance * (a - along * n);
  const Eigen::Matrix3d trial_tangent = stiffness / (distance * distance) *
                                            (3 * along * n * n.transpose() - a * n.transpose() -
                                             n * a.transpose() - along * identity) +
                                        stiffness / distance * across * entry.derivative;
  const double size = trial.norm(), limit = law.friction * pressure;
  result.slips = size > limit;
  if (!result.slips) {
    result.traction += trial;
    result.tangent += trial_tangent;
    result.energy += stiffness * (1 - along);
    result.anchor = a;
    return result;
  }
  const Eigen::Vector3d direction = trial / size;
  result.traction += limit * direction;
  result.tangent += -law.friction * law.normal_stiffness * direction * n.transpose() +
                    limit / size * (identity - direction * direction.transpose()) * trial_tangent;
  // The anchor that holds the point with just this traction.
  const double sine = std::min(limit * distance / stiffness, 1.0);
  result.anchor = std::sqrt(1 - sine * sine) * n + sine * direction;
  return result;
}

std::optional<ObstacleTraction> obstacle_traction(const RigidBlock& block, double stiffness,
                                                  const Eigen::Vector3d& point) {
  const Eigen::Vector3d centre = (block.low + block.high) / 2;
  const Eigen::Vector3d core = ((block.high - block.low) / 2).array() - block.rounding;
  const Eigen::Vector3d at = point - centre;
  const Eigen::Vector3d beyond = at.cwiseAbs() - core;
  const Eigen::Vector3d sign = at.unaryExpr([](double v) { return v < 0 ? -1.0 : 1.0; });
  if (beyond.maxCoeff() >= block.rounding) return std::nullopt;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  Eigen::Matrix3d curvature = Eigen::Matrix3d::Zero();
  double depth = 0;
  if (beyond.maxCoeff() <= 0) {
    Eigen::Index axis = 0;
    depth = block.rounding - beyond.maxCoeff(&axis);
    normal[axis] = sign[axis];
  } else {
    const Eigen::Vector3d outside = beyond.cwiseMax(0).cwiseProduct(sign);
    const double distance = outside.norm();
    depth = block.rounding - distance;
    if (depth <= 0) return std::nullopt;
    normal = outside / distance;
    for (int i = 0; i < 3; ++i) curvature(i, i) = beyond[i] > 0 ? 1 : 0;
    curvature = (curvature - normal * normal.transpose()) / distance;
  }
  return ObstacleTraction{stiffness * depth * normal,
                          stiffness * (depth * curvature - normal * normal.transpose())};
}

}  // namespace palpate::probing
