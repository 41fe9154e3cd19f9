// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/blended_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "model/contact_places.h"
#include "model/field_warp.h"
#include "model/force_variance.h"
#include "palpate/haptics/rotation.h"

namespace palpate::haptics {
namespace {

const Model& checked(const Model& model) {
  check_model(model);
  return model;
}

std::vector<Eigen::Matrix3d> pressing_frames(const Model& model) {
  std::vector<Eigen::Matrix3d> frames;
  for (const ContactModel& contact : model.contacts) frames.push_back(pressing_frame(contact));
  return frames;
}

// A frame whose z axis is the weighted mean of the frames' z axes. Its x axis is that of the frame
// with the largest weight, after the smallest rotation between the z axes.
Eigen::Matrix3d carried_frame(std::span<const Eigen::Matrix3d> frames,
                              std::span<const double> weights) noexcept {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < frames.size(); ++k) mean += weights[k] * frames[k].col(2);
  const auto heaviest = std::max_element(weights.begin(), weights.end()) - weights.begin();
  const Eigen::Matrix3d& frame = frames[static_cast<std::size_t>(heaviest)];
  // The z axes cancel only where the object has no inside to press into.
  return mean.norm() > 0 ? Eigen::Matrix3d(rotation_between(frame.col(2), mean) * frame) : frame;
}

geometry::ContactLocator make_locator(const Model& model, const geometry::SurfaceQuery& surface) {
  return {model.surface, contact_places(model, surface), vertex_weights(model)};
}

}  // namespace

BlendedField::BlendedField(const Model& model)
    : contacts_(checked(model).contacts),
      mesh_(model.surface),
      interpolation_(model.interpolation),
      friction_force_(model.friction_force),
      pressing_frames_(pressing_frames(model)),
      surface_(model.surface),
      locator_(make_locator(model, surface_)) {}

Blend BlendedField::blend(const Eigen::Vector3d& contact) const noexcept {
  return blend(surface_.closest_point(contact).at);
}

Blend BlendedField::blend(const geometry::SurfacePoint& contact) const noexcept {
  Blend result;
  result.friction_force = friction_force_;
  result.contacts = locator_.locate(contact);
  const auto count = static_cast<std::size_t>(result.contacts.count);
  if (count == 0) return result;
  std::array<Eigen::Matrix3d, geometry::ContactWeights::kMaxCount> frames;
  Eigen::Vector3d axis = Eigen::Vector3d::Zero();
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(result.contacts.contacts[k]);
    const double weight = result.contacts.weights[k];
    frames[k] = contacts_[i].frame;
    axis += weight * contacts_[i].friction_axis;
    result.friction += weight * contacts_[i].friction;
    result.load_exponent += weight * contacts_[i].load_exponent;
  }
  const std::span span(frames.data(), count);
  const std::span weights(result.contacts.weights.data(), count);
  const bool by_compliance = interpolation_.rule == BlendRule::compliances;
  result.frame = by_compliance ? carried_frame(span, weights) : blend_rotations(span, weights);
  // The axes of neighbours cancel only if they are opposite.
  result.friction_axis = axis.norm() > 0 ? Eigen::Vector3d(axis.normalized()) : result.frame.col(2);
  result.field_frame = result.frame;
  if (by_compliance) {
    warp_fields(contact, result);
  } else {
    const std::span<const int> indices(result.contacts.contacts.data(), count);
    const double factor = strength_factor(contacts_, indices, weights,
                                          geometry::position(mesh_, contact), interpolation_.reach);
    for (std::size_t k = 0; k < count; ++k) result.warps[k].energy = factor;
  }
  return result;
}

void BlendedField::warp_fields(const geometry::SurfacePoint& place, Blend& at) const noexcept {
  const auto count = static_cast<std::size_t>(at.contacts.count);
  const std::span indices(at.contacts.contacts.data(), count);
  const std::span weights(at.contacts.weights.data(), count);
  std::array<Eigen::Matrix3d, geometry::ContactWeights::kMaxCount> frames;
  bool any = false;
  for (std::size_t k = 0; k < count; ++k) {
    const auto i = static_cast<std::size_t>(indices[k]);
    frames[k] = pressing_frames_[i];
    any = any || (weights[k] > 0 && contacts_[i].compliance);
  }
  at.field_frame = carried_frame({frames.data(), count}, weights);
  Compliance here;
  if (any) {
    here =
        compliance_between(contacts_, pressing_frames_, indices, weights,
                           geometry::position(mesh_, place), at.field_frame, interpolation_.reach);
  }
  for (std::size_t k = 0; k < count; ++k) {
    if (!(weights[k] > 0)) continue;
    const ContactModel& contact = contacts_[static_cast<std::size_t>(indices[k])];
    if (contact.compliance) {
      const Eigen::Matrix2d turn = turn_between(frames[k], at.field_frame);
      at.warps[k] = warp_between(turned(contact.compliance->values, turn), here);
    }
    // Maps from the place's frame into the local frame, in which the field is given.
    const Eigen::Matrix3d carry = rotation_between(frames[k].col(2), at.field_frame.col(2));
    at.warps[k].displacement =
        (carry * contact.frame).transpose() * at.field_frame * at.warps[k].displacement;
  }
}

Eigen::Vector3d BlendedField::force(const Blend& at,
                                    const Eigen::Vector3d& displacement) const noexcept {
  Eigen::Vector3d local = Eigen::Vector3d::Zero();
  if (!displacement.allFinite()) return local;
  const Eigen::Vector3d local_displacement = at.field_frame.transpose() * displacement;
  for (std::size_t k = 0; k < static_cast<std::size_t>(at.contacts.count); ++k) {
    const auto i = static_cast<std::size_t>(at.contacts.contacts[k]);
    const FieldWarp& warp = at.warps[k];
    local += at.contacts.weights[k] * warp.energy *
             (warp.displacement.transpose() *
              haptics::force(contacts_[i].field, warp.displacement * local_displacement));
  }
  return at.field_frame * local;
}

Eigen::Matrix3d BlendedField::stiffness(const Blend& at,
                                        const Eigen::Vector3d& displacement) const noexcept {
  Eigen::Matrix3d local = Eigen::Matrix3d::Zero();
  if (!displacement.allFinite()) return local;
  const Eigen::Vector3d local_displacement = at.field_frame.transpose() * displacement;
  for (std::size_t k = 0; k < static_cast<std::size_t>(at.contacts.count); ++k) {
    const auto i = static_cast<std::size_t>(at.contacts.contacts[k]);
    const FieldWarp& warp = at.warps[k];
    local += at.contacts.weights[k] * warp.energy *
             (warp.displacement.transpose() *
              haptics::stiffness(contacts_[i].field, warp.displacement * local_displacement) *
              warp.displacement);
  }
  return at.field_frame * local * at.field_frame.transpose();
}

std::optional<double> BlendedField::deviation(const geometry::SurfacePoint& contact,
                                              const Eigen::Vector3d& displacement) const noexcept {
  const Blend at = blend(contact);
  if (at.contacts.count == 0 || !displacement.allFinite()) return std::nullopt;
  for (std::size_t k = 0; k < static_cast<std::size_t>(at.contacts.count); ++k) {
    const auto i = static_cast<std::size_t>(at.contacts.contacts[k]);
    if (at.contacts.weights[k] > 0 && !contacts_[i].uncertainty) return std::nullopt;
  }
  const ForceVariance parts =
      force_variance(contacts_, at, geometry::position(mesh_, contact), displacement);
  return std::sqrt(parts.contacts + parts.contrast + parts.between * parts.distance);
}

std::optional<double> BlendedField::deviation(const Eigen::Vector3d& contact,
                                              const Eigen::Vector3d& displacement) const noexcept {
  return deviation(surface_.closest_point(contact).at, displacement);
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
  parts.excess = parts.tangential -
                 friction_limit(at.friction, at.load_exponent, at.friction_force, parts.normal);
  return parts;
}

}  // namespace palpate::haptics
