// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/friction_cone.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "palpate/error.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

constexpr int kMinVectors = 5;  // three unknowns and something to check them with
// The directions around the axis must spread in the plane across it: smaller over larger principal
// value of their spread. A half circle has about 0.19.
constexpr double kMinSpread = 0.1;
constexpr int kMaxIterations = 100;
constexpr double kFirstDamping = 1e-3;  // of the mean curvature of the squares; adapts from there
constexpr double kSettled = 1e-10;      // [rad] last change of axis and angle
// Huber's threshold in standard deviations: 95 % efficient on normal errors (Huber 1981).
constexpr double kHuber = 1.345;
constexpr double kDeviationToSigma = 1.4826;  // median absolute deviation of normal errors
// Two samples have the same tangential direction iff the cosine between them is above this (2.5
// degrees); an arm probes in 8 or so directions.
constexpr double kSameDirection = 0.999;

// Cone in the frame of a direction near its axis: tilt (u, v) and half angle.
struct Parameters {
  Eigen::Matrix3d frame;  // third column: the axis
  double angle;
};

// Signed distance of a vector to the cone, and its derivatives for a small tilt of the axis in the
// frame and a change of the angle.
struct Residual {
  double value;
  Eigen::Vector3d slope;

  Residual(const Eigen::Vector3d& vector, const Parameters& cone) {
    const Eigen::Vector3d v = cone.frame.transpose() * vector;
    const double across = std::hypot(v.x(), v.y());
    const double cosine = std::cos(cone.angle), sine = std::sin(cone.angle);
    value = cosine * across - sine * v.z();
    const Eigen::Vector2d outwards =
        across > 0 ? Eigen::Vector2d(v.head<2>() / across) : Eigen::Vector2d::Zero();
    // axis -> axis + tilt: v.z grows by tilt . v_xy, |v_xy| shrinks by v.z tilt . outwards
    slope.head<2>() = -cosine * v.z() * outwards - sine * v.head<2>();
    slope[2] = -sine * across - cosine * v.z();
  }
};

Eigen::Matrix3d frame_of(const Eigen::Vector3d& axis) {
  return rotation_between(Eigen::Vector3d::UnitZ(), axis);
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> distances(const Eigen::Ref<const Eigen::Matrix3Xd>& vectors,
                              const Parameters& cone) {
  std::vector<double> result;
  for (const auto& vector : vectors.colwise()) result.push_back(Residual(vector, cone).value);
  return result;
}

// Threshold between small and large distances, from their median.
double huber_threshold(std::vector<double> values) {
  for (double& value : values) value = std::abs(value);
  return kHuber * kDeviationToSigma * median(std::move(values));
}

double huber_cost(const std::vector<double>& values, double threshold) {
  double cost = 0;
  for (const double value : values) {
    const double size = std::abs(value);
    cost += size <= threshold ? size * size / 2 : threshold * (size - threshold / 2);
  }
  return cost;
}

// Levenberg-Marquardt on iteratively reweighted squares; false if it did not settle.
bool minimise(const Eigen::Ref<const Eigen::Matrix3Xd>& vectors, double threshold,
              Parameters& cone) {
  double damping = kFirstDamping, cost = huber_cost(distances(vectors, cone), threshold);
  for (int i = 0; i < kMaxIterations; ++i) {
    Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
    for (const auto& vector : vectors.colwise()) {
      const Residual residual(vector, cone);
      const double size = std::abs(residual.value);
      const double weight = size <= threshold ? 1 : threshold / size;
      normal += weight * residual.slope * residual.slope.transpose();
      gradient += weight * residual.value * residual.slope;
    }
    // Three well-scaled unknowns (angles): normal equations lose nothing here.
    const Eigen::Matrix3d damped =
        normal + damping * normal.trace() / 3 * Eigen::Matrix3d::Identity();
    const Eigen::Vector3d step = -damped.ldlt().solve(gradient);
    if (!step.allFinite()) return false;
    Parameters next = cone;
    next.frame = cone.frame * rotation_exp({-step.y(), step.x(), 0});
    next.angle = cone.angle + step.z();
    const double next_cost = huber_cost(distances(vectors, next), threshold);
    if (next_cost <= cost) {
      cone = next;
      cost = next_cost;
      damping /= 10;
    } else {
      damping *= 10;
    }
    if (step.norm() < kSettled) return true;
  }
  return false;
}

bool directions_spread(const Eigen::Ref<const Eigen::Matrix3Xd>& vectors,
                       const Eigen::Vector3d& axis) {
  const Eigen::Matrix3d frame = frame_of(axis);
  Eigen::Matrix2d spread = Eigen::Matrix2d::Zero();
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  const double count = static_cast<double>(vectors.cols());
  for (const auto& vector : vectors.colwise()) {
    const Eigen::Vector2d across = (frame.transpose() * vector).head<2>().normalized();
    spread += across * across.transpose() / count;
    mean += across / count;
  }
  spread -= mean * mean.transpose();
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen(spread, Eigen::EigenvaluesOnly);
  return eigen.eigenvalues()[0] >= kMinSpread * eigen.eigenvalues()[1];
}

// The axis to start from: each vector counts alike, however long.
Eigen::Vector3d mean_direction(const Eigen::Ref<const Eigen::Matrix3Xd>& vectors) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const auto& vector : vectors.colwise()) sum += vector.normalized();
  return sum.normalized();
}

}  // namespace

ConeFit fit_cone(const Eigen::Ref<const Eigen::Matrix3Xd>& vectors) {
  ConeFit fit;
  for (Eigen::Index i = 0; i < vectors.cols(); ++i) {
    if (!vectors.col(i).allFinite()) {
      throw InvalidInput("fit_cone(): vector " + std::to_string(i) +
                         " is not finite; leave it out");
    }
  }
  fit.cone.samples = static_cast<int>(vectors.cols());
  const Eigen::Vector3d start = mean_direction(vectors);
  if (vectors.cols() < kMinVectors || !(start.norm() > 0) || !directions_spread(vectors, start)) {
    return fit;
  }
  Parameters cone{frame_of(start), 0};
  std::vector<double> angles;
  for (const auto& vector : vectors.colwise()) {
    const Eigen::Vector3d v = cone.frame.transpose() * vector;
    angles.push_back(std::atan2(v.head<2>().norm(), v.z()));
  }
  cone.angle = median(std::move(angles));
  // Plain squares first, then against outliers with the scale of the distances that are left.
  constexpr double kNoThreshold = std::numeric_limits<double>::infinity();
  bool settled = minimise(vectors, kNoThreshold, cone);
  const double threshold = huber_threshold(distances(vectors, cone));
  if (settled && threshold > 0) settled = minimise(vectors, threshold, cone);
  fit.cone.axis = cone.frame.col(2);
  fit.cone.slope = std::tan(cone.angle);
  double sum = 0;
  for (const double distance : distances(vectors, cone)) sum += distance * distance;
  fit.cone.rms = std::sqrt(sum / static_cast<double>(vectors.cols()));
  const bool is_cone = cone.angle >= 0 && cone.angle < std::acos(0.0);
  fit.stop = settled && is_cone ? ConeStop::converged : ConeStop::not_converged;
  return fit;
}

Eigen::Matrix3Xd boundary_forces(const probing::Contact& contact,
                                 std::span<const probing::Sample> samples) {
  const Eigen::Vector3d normal = contact.normal.normalized();
  const auto tangential = [&](const probing::Sample& sample) -> Eigen::Vector3d {
    return sample.force - sample.force.dot(normal) * normal;
  };
  std::vector<Eigen::Vector3d> forces;
  for (const probing::Sample& held : samples) {
    if (held.contact != contact.id || !held.on_friction_boundary) continue;
    const Eigen::Vector3d held_force = tangential(held);
    const probing::Sample* next = nullptr;
    for (const probing::Sample& other : samples) {
      if (other.contact != contact.id || other.group != held.group || !other.slipped) continue;
      const Eigen::Vector3d force = tangential(other);
      if (held_force.dot(force) < kSameDirection * held_force.norm() * force.norm()) continue;
      if (force.norm() < held_force.norm()) continue;
      if (!next || force.norm() < tangential(*next).norm()) next = &other;
    }
    forces.push_back(next ? Eigen::Vector3d((held.force + next->force) / 2) : held.force);
  }
  Eigen::Matrix3Xd result(3, static_cast<Eigen::Index>(forces.size()));
  for (std::size_t i = 0; i < forces.size(); ++i)
    result.col(static_cast<Eigen::Index>(i)) = forces[i];
  return result;
}

std::optional<Eigen::Vector3d> friction_axis(const probing::Contact& contact,
                                             std::span<const probing::Sample> samples) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (const probing::Sample& sample : samples) {
    if (sample.contact == contact.id && sample.on_friction_boundary) {
      sum += sample.b - contact.position;
    }
  }
  const double length = sum.norm();
  if (!(length > 0)) return std::nullopt;
  return sum / length;
}

}  // namespace palpate::haptics
