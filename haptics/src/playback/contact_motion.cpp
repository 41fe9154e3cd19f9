// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/contact_motion.h"

#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>

namespace palpate::haptics {
namespace {

// The place where the contact holds again is searched in doubling steps from 2^-kSteps of the way.
// h has a second minimum on the far side of the friction cone, to which a slipping contact must not
// jump.
constexpr int kSteps = 8;
// Brent's method then stops when t is known to 2^-kBits of that step, or after kMaxEvaluations.
// Both limit the time of a tick.
constexpr int kBits = 14;
constexpr std::uintmax_t kMaxEvaluations = 16;
// The friction axis is used where the cosine between it and the inward normal is at least this (75
// degrees); nearer to the tangent plane the line along it would run far away.
constexpr double kMinAxisCosine = 0.26;

// From the contact to the intersection of the tangent plane with the friction axis through the
// tool.
Eigen::Vector3d travel(const Blend& at, const TouchPoint& contact, const Eigen::Vector3d& tool) {
  const Eigen::Vector3d displacement = tool - contact.position;
  Eigen::Vector3d axis = at.friction_axis;
  if (-axis.dot(contact.normal) < kMinAxisCosine) axis = -contact.normal;
  return displacement - axis * (displacement.dot(contact.normal) / axis.dot(contact.normal));
}

}  // namespace

TouchPoint slip_contact(const BlendedField& field, const Eigen::Matrix3Xd& normals,
                        const TouchPoint& contact, const Eigen::Vector3d& tool) noexcept {
  const Eigen::Vector3d line = travel(field.blend(contact.at), contact, tool);
  if (!line.allFinite()) return contact;
  const auto place = [&](double t) {
    return field.surface().closest_point(contact.position + t * line);
  };
  const auto excess = [&](double t) {
    const geometry::ClosestPoint candidate = place(t);
    const Blend at = field.blend(candidate.at);
    return friction_parts(at, field.force(at, tool - candidate.position)).excess;
  };
  const auto h = [&](double t) {
    const double value = excess(t);
    return value * value;
  };
  double low = 0, high = std::ldexp(1.0, -kSteps);
  while (high < 1 && excess(high) > 0) {
    low = high;
    high *= 2;
  }
  // The contact holds nowhere before the end, so the minimum of h may be anywhere.
  if (high >= 1 && excess(1) > 0) low = 0;
  std::uintmax_t evaluations = kMaxEvaluations;
  const double t = boost::math::tools::brent_find_minima(h, low, high, kBits, evaluations).first;
  const geometry::ClosestPoint found = place(t);
  if (found.at.triangle < 0) return contact;
  const Eigen::Vector3d normal = normals.col(found.at.triangle);
  return {found.position, normal.allFinite() ? normal : contact.normal, found.at};
}

}  // namespace palpate::haptics
