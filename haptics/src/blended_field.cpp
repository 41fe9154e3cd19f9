// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/blended_field.h"

#include <array>

#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

const Model& checked(const Model& model) {
  check_model(model);
  return model;
}

}  // namespace

BlendedField::BlendedField(const Model& model)
    : contacts_(checked(model).contacts), locator_(contact_mesh(model)) {}

Blend BlendedField::blend(const Eigen::Vector3d& contact) const noexcept {
  const geometry::ContactWeights place = locator_.locate(contact);
  Blend result;
  if ((place.contacts.array() < 0).any()) return result;
  result.contacts = place.contacts;
  result.weights = place.weights;
  std::array<Eigen::Matrix3d, 3> frames;
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  for (int k = 0; k < 3; ++k) {
    const ContactModel& neighbour = contacts_[static_cast<std::size_t>(place.contacts[k])];
    frames[static_cast<std::size_t>(k)] = neighbour.frame;
    axis += place.weights[k] * neighbour.friction_axis;
    result.friction += place.weights[k] * neighbour.friction;
  }
  result.frame = blend_rotations(frames, place.weights);
  // Axes of neighbours may cancel each other only if they are opposite.
  result.friction_axis = axis.norm() > 0 ? Eigen::Vector3d(axis.normalized()) : result.frame.col(2);
  return result;
}

Eigen::Vector3d BlendedField::force(const Blend& at,
                                    const Eigen::Vector3d& displacement) const noexcept {
  Eigen::Vector3d local = Eigen::Vector3d::Zero();
  if (at.contacts[0] < 0 || !displacement.allFinite()) return local;
  const Eigen::Vector3d local_displacement = at.frame.transpose() * displacement;
  for (int k = 0; k < 3; ++k) {
    if (at.weights[k] == 0) continue;
    const ContactModel& neighbour = contacts_[static_cast<std::size_t>(at.contacts[k])];
    local += at.weights[k] * haptics::force(neighbour.field, local_displacement);
  }
  return at.frame * local;
}

Eigen::Vector3d BlendedField::force(const Eigen::Vector3d& contact,
                                    const Eigen::Vector3d& displacement) const noexcept {
  return force(blend(contact), displacement);
}

FrictionParts friction_parts(const Blend& at, const Eigen::Vector3d& force) noexcept {
  const Eigen::Vector3d axis = at.frame.col(2);
  FrictionParts parts;
  parts.normal = force.dot(axis);
  parts.tangential = (force - parts.normal * axis).norm();
  parts.excess = parts.tangential - at.friction * parts.normal;
  return parts;
}

}  // namespace palpate::haptics
