// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/stored_form.h"

#include <algorithm>
#include <cmath>

#include "palpate/haptics/rounding.h"

namespace palpate::haptics {
namespace {

template <typename Vector>
double largest_entry(const Vector& v) {
  Eigen::Index index = 0;
  v.cwiseAbs().maxCoeff(&index);
  return v[index];
}

double to_places(double entry) { return round_to_places(entry, kFieldDigits); }

// Decimal places to which a slope is rounded. Weight and epsilon depend on the errors of all three
// entries. One more digit if the largest entry begins with 1 or 2 keeps them within
// CertificateOptions::number_tolerance.
int places_of(const Eigen::Vector3d& slope) {
  constexpr double kEnough = 3;
  const double largest = slope.cwiseAbs().maxCoeff();
  const int before_point = static_cast<int>(std::floor(std::log10(largest / kEnough))) + 1;
  return std::max(kFieldDigits - before_point, 0);
}

}  // namespace

double length_of(const Eigen::Vector3d& slope) {
  return std::hypot(slope.x(), slope.y(), slope.z());
}

StoredRidge to_stored(const Multiquadric& ridge) {
  return {ridge.weight * ridge.epsilon, ridge.ridge.dot(ridge.center) / ridge.epsilon,
          ridge.ridge / ridge.epsilon};
}

Multiquadric to_ridge(const StoredRidge& stored) {
  const double norm = length_of(stored.slope);
  const Eigen::Vector3d along = stored.slope / norm;
  return {stored.weight * norm, 1 / norm, stored.offset / norm * along, along};
}

StoredRidge rounded(StoredRidge stored) {
  stored.weight = round_to_digits(stored.weight, kFieldDigits);
  stored.offset = round_to_digits(stored.offset, kFieldDigits);
  const auto slope_with = [&](int places) -> Eigen::Vector3d {
    return stored.slope.unaryExpr([&](double entry) { return round_to_places(entry, places); });
  };
  // Rounding may move the largest entry over a bound at which the number of places changes.
  // Rounding again must not remove another place.
  const int places = places_of(stored.slope);
  stored.slope = slope_with(std::min(places, places_of(slope_with(places))));
  return stored;
}

Eigen::Vector4d to_quaternion(const Eigen::Matrix3d& frame) {
  const Eigen::Quaterniond q(frame);
  const Eigen::Vector4d entries(q.w(), q.x(), q.y(), q.z());
  return entries / largest_entry(entries);
}

Eigen::Matrix3d to_frame(const Eigen::Vector4d& quaternion) {
  // The squared length may underflow, so scale first.
  const Eigen::Vector4d scaled = quaternion / std::abs(largest_entry(quaternion));
  const double w = scaled[0], x = scaled[1], y = scaled[2], z = scaled[3];
  const double twice = 2 / scaled.squaredNorm();
  Eigen::Matrix3d frame;
  frame << 1 - twice * (y * y + z * z), twice * (x * y - w * z), twice * (x * z + w * y),  //
      twice * (x * y + w * z), 1 - twice * (x * x + z * z), twice * (y * z - w * x),       //
      twice * (x * z - w * y), twice * (y * z + w * x), 1 - twice * (x * x + y * y);
  return frame;
}

Eigen::Vector3d to_direction(const Eigen::Vector3d& axis) {
  return axis / std::abs(largest_entry(axis));
}

Eigen::Vector4d rounded(const Eigen::Vector4d& quaternion) {
  return quaternion.unaryExpr(&to_places);
}

Eigen::Vector3d rounded(const Eigen::Vector3d& direction) {
  return direction.unaryExpr(&to_places);
}

}  // namespace palpate::haptics
