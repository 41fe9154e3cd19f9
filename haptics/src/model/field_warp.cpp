// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/field_warp.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

Eigen::Matrix2d across(const Compliance& compliance) {
  Eigen::Matrix2d matrix;
  matrix << compliance(3), compliance(4), compliance(4), compliance(5);
  return matrix;
}

// The geometric mean of positive definite matrices: the only X > 0 with X a^-1 X = b.
Eigen::Matrix2d geometric_mean(const Eigen::Matrix2d& a, const Eigen::Matrix2d& b) {
  const double scale_a = std::sqrt(a.determinant()), scale_b = std::sqrt(b.determinant());
  const Eigen::Matrix2d sum = a / scale_a + b / scale_b;
  return std::sqrt(scale_a * scale_b / sum.determinant()) * sum;
}

// Size of `change` relative to `mean`: the larger of the relative change of u_z and the Frobenius
// norm of that of c, which bounds its eigenvalues.
double relative_change(const Compliance& change, const Compliance& mean) {
  const Eigen::Matrix2d relative = across(mean).inverse() * across(change);
  // The matrix is similar to a symmetric one, so this trace is its squared Frobenius norm.
  const double square = (relative * relative).trace();
  return std::max(std::abs(change(2)) / mean(2), std::sqrt(std::max(square, 0.0)));
}

// Factors of the derivatives in `trend`, for the step from a contact to a place: u to the mean of
// the contacts, v beyond it.
Eigen::Vector<double, 5> steps_of_trend(const Eigen::Vector2d& u, const Eigen::Vector2d& v) {
  const Eigen::Matrix2d square = u * u.transpose() / 6 + u * v.transpose() + v * v.transpose() / 2;
  Eigen::Vector<double, 5> steps;
  steps << 2.0 / 3 * u + v, square(0, 0), square(0, 1) + square(1, 0), square(1, 1);
  return steps;
}

// The mean of the contacts that `is_known`, and how far the place lies beyond.
struct Middle {
  double weights = 0;
  Eigen::Vector3d position = Eigen::Vector3d::Zero(), beyond = Eigen::Vector3d::Zero();
};

template <typename IsKnown>
Middle middle_of(const std::vector<ContactModel>& contacts, std::span<const int> indices,
                 std::span<const double> weights, const Eigen::Vector3d& place, double reach,
                 IsKnown is_known) {
  Middle middle;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const ContactModel& contact = contacts[static_cast<std::size_t>(indices[k])];
    if (!is_known(contact)) continue;
    middle.weights += weights[k];
    middle.position += weights[k] * contact.position;
  }
  middle.position /= middle.weights;
  middle.beyond = place - middle.position;
  const double distance = middle.beyond.norm();
  if (distance > reach) middle.beyond *= reach / distance;
  return middle;
}

}  // namespace

Compliance turned(const Compliance& compliance, const Eigen::Matrix2d& turn) noexcept {
  const Eigen::Matrix2d c = turn * across(compliance) * turn.transpose();
  Compliance result;
  result << turn * compliance.head<2>(), compliance(2), c(0, 0), (c(0, 1) + c(1, 0)) / 2, c(1, 1);
  return result;
}

Eigen::Matrix2d turn_between(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to) noexcept {
  const Eigen::Matrix3d carry = rotation_between(from.col(2), to.col(2));
  return (to.transpose() * carry * from).topLeftCorner<2, 2>();
}

Compliance compliance_between(const std::vector<ContactModel>& contacts,
                              std::span<const Eigen::Matrix3d> pressing_frames,
                              std::span<const int> indices, std::span<const double> weights,
                              const Eigen::Vector3d& place, const Eigen::Matrix3d& frame,
                              double reach) noexcept {
  const Middle middle =
      middle_of(contacts, indices, weights, place, reach,
                [](const ContactModel& contact) { return contact.compliance.has_value(); });
  Compliance mean = Compliance::Zero(), change = Compliance::Zero();
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const ContactModel& contact = contacts[static_cast<std::size_t>(indices[k])];
    if (!contact.compliance) continue;
    const Eigen::Matrix3d& own = pressing_frames[static_cast<std::size_t>(indices[k])];
    const auto axes = own.leftCols<2>().transpose();
    const Eigen::Vector<double, 5> steps =
        steps_of_trend(axes * (middle.position - contact.position), axes * middle.beyond);
    const Eigen::Matrix2d turn = turn_between(own, frame);
    const double weight = weights[k] / middle.weights;
    mean += weight * turned(contact.compliance->values, turn);
    change += weight * turned(contact.compliance->trend * steps, turn);
  }
  return limited(mean, change);
}

double strength_factor(const std::vector<ContactModel>& contacts, std::span<const int> indices,
                       std::span<const double> weights, const Eigen::Vector3d& place,
                       double reach) noexcept {
  const Middle middle =
      middle_of(contacts, indices, weights, place, reach,
                [](const ContactModel& contact) { return contact.strength.has_value(); });
  double mean = 0, change = 0;
  for (std::size_t k = 0; k < indices.size(); ++k) {
    const ContactModel& contact = contacts[static_cast<std::size_t>(indices[k])];
    if (!contact.strength) continue;
    const auto axes = contact.frame.leftCols<2>().transpose();
    mean += weights[k] * contact.strength->value;
    change += weights[k] * contact.strength->trend.dot(steps_of_trend(
                               axes * (middle.position - contact.position), axes * middle.beyond));
  }
  return mean > 0 ? 1 + std::clamp(change / mean, -kMaxChange, kMaxChange) : 1;
}

Compliance limited(const Compliance& mean, const Compliance& change) noexcept {
  const double size = relative_change(change, mean);
  return mean + (size > kMaxChange ? kMaxChange / size : 1) * change;
}

FieldWarp warp_between(const Compliance& from, const Compliance& to) noexcept {
  FieldWarp warp;
  warp.energy = to(2) / from(2);
  // With X = c_from # c_to^-1 the stiffness across, energy A^T c_from^-1 A, becomes c_to^-1 for
  // A = X / sqrt(energy). The third row keeps the force at the displacement along z.
  const Eigen::Matrix2d block =
      geometric_mean(across(from), across(to).inverse()) / std::sqrt(warp.energy);
  warp.displacement.setZero();
  warp.displacement.topLeftCorner<2, 2>() = block;
  warp.displacement.topRightCorner<2, 1>() = (from.head<2>() - block * to.head<2>()) / to(2);
  warp.displacement(2, 2) = 1 / warp.energy;
  return warp;
}

}  // namespace palpate::haptics
