// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/contact_motion.h"

#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>

#include "playback/slip_search.h"

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
// Number of halvings of the line in the search for the friction boundary: to 1e-7 of it.
constexpr int kHalvings = 24;

TouchPoint touch_point(const BlendedField& field, const Eigen::Matrix3Xd& normals,
                       const TouchPoint& contact, const Eigen::Vector3d& place) {
  const geometry::ClosestPoint found = field.surface().closest_point(place);
  if (found.at.triangle < 0) return contact;
  const Eigen::Vector3d normal = normals.col(found.at.triangle);
  return {found.position, normal.allFinite() ? normal : contact.normal, found.at};
}

}  // namespace

TouchPoint slip_contact(const BlendedField& field, const Eigen::Matrix3Xd& normals,
                        const TouchPoint& contact, const Eigen::Vector3d& tool) noexcept {
  const Eigen::Vector3d line =
      slip_line(field.blend(contact.at).friction_axis, contact.normal, tool - contact.position);
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
  return touch_point(field, normals, contact, contact.position + t * line);
}

TouchPoint slip_by_boundary(const BlendedField& field, const Eigen::Matrix3Xd& normals,
                            const TouchPoint& contact, const Eigen::Vector3d& tool) noexcept {
  const Blend at = field.blend(contact.at);
  const Eigen::Vector3d displacement = tool - contact.position;
  const Eigen::Vector3d on_axis = displacement.dot(at.friction_axis) * at.friction_axis;
  const Eigen::Vector3d line = displacement - on_axis;
  double inside = 0, outside = 1;
  for (int i = 0; i < kHalvings; ++i) {
    const double middle = (inside + outside) / 2;
    const Eigen::Vector3d force = field.force(at, on_axis + middle * line);
    (friction_parts(at, force).excess > 0 ? outside : inside) = middle;
  }
  return touch_point(field, normals, contact, contact.position + (1 - inside) * line);
}

}  // namespace palpate::haptics
