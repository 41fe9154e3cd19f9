// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "playback/sliding_contact.h"

namespace palpate::haptics {
namespace {

// Within 1e-3 of what is delayed; what is left pushes.
constexpr int kFollowingHalvings = 10;

}  // namespace

void let_follow(const PackedField& field, const PlaceField& place, const Eigen::Vector3d& tool,
                DelayedDisplacements& delayed, SlidingContact& contact) noexcept {
  if (field.rate().empty() || !(contact.parts.normal < 0)) return;
  const Eigen::Vector3d displacement = tool - contact.at.position;
  const DelayedDisplacements before = delayed;
  double low = 0, high = 1;
  const auto follow = [&](double part) {
    for (std::size_t i = 0; i < before.of.size(); ++i)
      delayed.of[i] = displacement - part * (displacement - before.of[i]);
    contact.force = field.force(place, displacement, delayed);
    contact.parts = friction_parts(place, contact.force.force);
    return contact.parts.normal >= 0;
  };
  for (int i = 0; i < kFollowingHalvings; ++i) {
    const double middle = (low + high) / 2;
    (follow(middle) ? low : high) = middle;
  }
  follow(low);
}

double cost_of(const SlidingContact& contact, const Eigen::Vector3d& moved) noexcept {
  return contact.force.energy - contact.force.force.dot(moved) / 2;
}

Eigen::Vector3d slip_line(const Eigen::Vector3d& friction_axis, const Eigen::Vector3d& normal,
                          const Eigen::Vector3d& displacement) noexcept {
  Eigen::Vector3d axis = friction_axis;
  if (!(-axis.dot(normal) >= kMinAxisCosine * axis.norm())) axis = -normal;
  return displacement - axis * (displacement.dot(normal) / axis.dot(normal));
}

}  // namespace palpate::haptics
