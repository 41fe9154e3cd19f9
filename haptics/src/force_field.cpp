// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/force_field.h"

#include <cmath>
#include <string>

#include "palpate/error.h"

namespace palpate::haptics {
namespace {

double rounded_length(const Eigen::Vector3d& d, double epsilon) noexcept {
  return std::sqrt(d.squaredNorm() + epsilon * epsilon);
}

}  // namespace

void check_force_field(const ForceField& field, const char* what) {
  if (field.centers.cols() != field.weights.size()) {
    throw InvalidInput(std::string(what) + ": " + std::to_string(field.centers.cols()) +
                       " centres but " + std::to_string(field.weights.size()) +
                       " weights; each base has one of both");
  }
  for (Eigen::Index k = 0; k < field.weights.size(); ++k) {
    if (!field.centers.col(k).allFinite() || !std::isfinite(field.weights[k])) {
      throw InvalidInput(std::string(what) + ": base " + std::to_string(k) + " is not finite");
    }
  }
  if (!(field.epsilon > 0) || !std::isfinite(field.epsilon)) {
    throw InvalidInput(std::string(what) + ": epsilon is " + std::to_string(field.epsilon) +
                       " mm; it must be finite and > 0");
  }
}

double potential(const ForceField& field, const Eigen::Vector3d& displacement) noexcept {
  double result = 0;
  for (Eigen::Index k = 0; k < field.weights.size(); ++k) {
    const Eigen::Vector3d center = field.centers.col(k);
    const double at_zero = rounded_length(center, field.epsilon);
    const double here = rounded_length(displacement - center, field.epsilon);
    // s(x) - s(0) = (s(x)^2 - s(0)^2) / (s(x) + s(0)), which does not cancel for small
    // displacements.
    const double difference = displacement.dot(displacement - 2 * center) / (here + at_zero);
    result += field.weights[k] * (difference + center.dot(displacement) / at_zero);
  }
  return result;
}

Eigen::Vector3d force(const ForceField& field, const Eigen::Vector3d& displacement) noexcept {
  Eigen::Vector3d result = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 0; k < field.weights.size(); ++k) {
    const Eigen::Vector3d center = field.centers.col(k);
    const Eigen::Vector3d d = displacement - center;
    result += field.weights[k] * (d / rounded_length(d, field.epsilon) +
                                  center / rounded_length(center, field.epsilon));
  }
  return result;
}

Eigen::Matrix3d stiffness(const ForceField& field, const Eigen::Vector3d& displacement) noexcept {
  Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
  for (Eigen::Index k = 0; k < field.weights.size(); ++k) {
    const Eigen::Vector3d d = displacement - field.centers.col(k);
    const double s = rounded_length(d, field.epsilon);
    const Eigen::Vector3d q = d / s;
    result += field.weights[k] / s * (Eigen::Matrix3d::Identity() - q * q.transpose());
  }
  return result;
}

}  // namespace palpate::haptics
