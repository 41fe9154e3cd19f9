// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "friction/slip_likelihood.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

constexpr int kMaxConeIterations = 100;
constexpr double kFirstConeDamping = 1e-3;  // of the information's diagonal; adapted later
constexpr double kMaxConeDamping = 1e9;     // no shorter step helps, so the search ends
// Smallest damping relative to the mean diagonal, for directions without information.
constexpr double kLeastInformation = 1e-9;
// The search ends when a step promises a smaller gain of the log-likelihood than this: the
// parameters are then within some 1e-5 standard errors.
constexpr double kLeastGain = 1e-10;
constexpr double kMaxTurn = 0.2;  // [rad] and relative to the noise, in one step
// Beyond this many standard deviations a trial's outcome is certain except for lapses: Phi < 1e-15.
constexpr double kCertain = 8;
const double kCertainCost = -std::log(1 - kLapse), kLapseCost = -std::log(kLapse);

// Signed distance of a force from the cone, and its derivatives by rotations about the frame's x
// and y axes and by the angle.
struct Distance {
  double value;
  Eigen::Vector3d slope;

  Distance(const Eigen::Vector3d& force, const SlipCone& cone, double cosine, double sine) {
    const Eigen::Vector3d f = cone.frame.transpose() * force;
    const double across = std::hypot(f.x(), f.y());
    value = cosine * across - sine * f.z();
    // A rotation (x, y) adds (y, -x) to the axis: f.z increases by that times f_xy, and |f_xy|
    // decreases by f.z times its outward part.
    const double pull = across > 0 ? cosine * f.z() / across + sine : sine;
    slope = {pull * f.y(), -pull * f.x(), -sine * across - cosine * f.z()};
  }
};

// Contribution of a trial to the cost, its first and second derivative by the distance (in units of
// the noise), and the expected second derivative.
struct Part {
  double cost, slope = 0, curvature = 0, information = 0;

  Part(double distance, bool slipped, double noise) {
    const double z = (slipped ? distance : -distance) / noise;
    if (std::abs(z) > kCertain) {
      cost = z > 0 ? kCertainCost : kLapseCost;
      return;
    }
    constexpr double kTrust = 1 - 2 * kLapse;
    const double seen = kLapse + kTrust * std::erfc(-z / std::numbers::sqrt2) / 2;
    const double density = kTrust * std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi);
    cost = -std::log(seen);
    slope = (slipped ? -1 : 1) * density / seen;
    curvature = z * density / seen + slope * slope;
    information = density * density / (seen * (1 - seen));
  }
};

struct Evaluation {
  double cost = 0;
  Eigen::Vector4d gradient = Eigen::Vector4d::Zero();
  Eigen::Matrix4d information = Eigen::Matrix4d::Zero();
  // Used for steps. If few trials surround the boundary, they curve the cost more than expected,
  // and steps by the expected information would oscillate around the optimum.
  Eigen::Matrix4d curvature = Eigen::Matrix4d::Zero();
};

Evaluation evaluate(std::span<const FrictionTrial> trials, const SlipCone& cone) {
  const double cosine = std::cos(cone.angle), sine = std::sin(cone.angle);
  Evaluation result;
  for (const FrictionTrial& trial : trials) {
    const Distance distance(trial.force, cone, cosine, sine);
    const Part part(distance.value, trial.slipped, cone.noise);
    result.cost += part.cost;
    if (part.slope == 0) continue;
    Eigen::Vector4d slope;  // of distance / noise
    slope << distance.slope / cone.noise, -distance.value / cone.noise;
    result.gradient += part.slope * slope;
    const Eigen::Matrix4d square = slope * slope.transpose();
    result.information += part.information * square;
    result.curvature += std::max(part.information, part.curvature) * square;
  }
  return result;
}

// The step of the free parameters, within the limits; the others stay.
Eigen::Vector4d damped_step(const Evaluation& at, const std::array<bool, 4>& free, double damping) {
  Eigen::Vector4d gradient = at.gradient;
  Eigen::Matrix4d matrix = at.curvature;
  // Well-scaled unknowns (angles and a logarithm): normal equations lose nothing here.
  const double mean = matrix.trace() / 4;
  for (int i = 0; i < 4; ++i) {
    matrix(i, i) += damping * matrix(i, i) + kLeastInformation * mean;
    if (free[static_cast<std::size_t>(i)]) continue;
    matrix.row(i).setZero();
    matrix.col(i).setZero();
    matrix(i, i) = 1;
    gradient[i] = 0;
  }
  const Eigen::Vector4d step = -matrix.ldlt().solve(gradient);
  const double largest = step.cwiseAbs().maxCoeff();
  return largest > kMaxTurn ? Eigen::Vector4d(step * (kMaxTurn / largest)) : step;
}

}  // namespace

SlipCone SlipCone::tilted(double x, double y) const {
  SlipCone result = *this;
  result.frame = frame * rotation_exp({x, y, 0});
  return result;
}

double slip_cost(std::span<const FrictionTrial> trials, const SlipCone& cone) {
  const double cosine = std::cos(cone.angle), sine = std::sin(cone.angle);
  double cost = 0;
  for (const FrictionTrial& trial : trials) {
    const Eigen::Vector3d f = cone.frame.transpose() * trial.force;
    cost += Part(cosine * std::hypot(f.x(), f.y()) - sine * f.z(), trial.slipped, cone.noise).cost;
  }
  return cost;
}

SlipOptimum maximise_likelihood(std::span<const FrictionTrial> trials, const SlipCone& start,
                                FreeParameters free, double least_noise) {
  SlipOptimum best{.cone = start};
  Evaluation at = evaluate(trials, best.cone);
  double damping = kFirstConeDamping;
  for (int i = 0; i < kMaxConeIterations && !best.converged; ++i) {
    // Keep a parameter that is at its limit and pushed against it.
    const bool narrowest = best.cone.angle <= 0 && at.gradient[2] >= 0,
               widest = best.cone.angle >= kRightAngle && at.gradient[2] <= 0,
               quietest = best.cone.noise <= least_noise && at.gradient[3] >= 0;
    const std::array<bool, 4> moves = {true, true,
                                       free != FreeParameters::axis && !narrowest && !widest,
                                       free == FreeParameters::axis_angle_noise && !quietest};
    const Eigen::Vector4d step = damped_step(at, moves, damping);
    if (!step.allFinite()) break;
    SlipCone next = best.cone.tilted(step[0], step[1]);
    next.angle = std::clamp(next.angle + step[2], 0.0, kRightAngle);
    next.noise = std::max(least_noise, next.noise * std::exp(step[3]));
    best.converged = -at.gradient.dot(step) < kLeastGain;
    const Evaluation there = evaluate(trials, next);
    if (there.cost <= at.cost) {
      best.cone = next;
      at = there;
      damping /= 10;
    } else {
      damping *= 10;
    }
    best.converged = best.converged || damping > kMaxConeDamping;
  }
  best.cost = at.cost;
  best.information = at.information;
  return best;
}

}  // namespace palpate::haptics
