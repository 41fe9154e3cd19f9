// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/packed_field.h"

#include <atomic>
#include <cmath>

#include "model/field_warp.h"
#include "playback/packed_kernels.h"

namespace palpate::haptics {
namespace {

std::uint64_t next_id_of_field() {
  static std::atomic<std::uint64_t> last = 0;
  return ++last;
}

}  // namespace

PackedField::PackedField(const Model& model)
    : blended_(model),
      reach_(model.interpolation.reach),
      friction_force_(model.friction_force),
      rate_(model.rate),
      id_(next_id_of_field()),
      by_compliance_(model.interpolation.rule == BlendRule::compliances) {
  for (const ContactModel& contact : model.contacts) pack(contact);
}

void PackedField::pack(const ContactModel& contact) {
  const Eigen::Matrix3d pressing = pressing_frame(contact);
  const Eigen::Matrix3d to_pressing = pressing.transpose() * contact.frame;
  local_to_pressing_.push_back(to_pressing);
  has_compliance_.push_back(contact.compliance ? 1 : 0);

  BaseRange range{.first_isotropic = static_cast<int>(isotropic_.size()),
                  .first_ridge = static_cast<int>(ridges_.size())};
  std::size_t isotropic = 0, ridges = 0;
  constexpr Lanes kOnes{{1, 1, 1, 1}};
  for (const Multiquadric& base : contact.field.bases) {
    if (is_ridge(base)) {
      if (ridges % 4 == 0) {
        ridges_.push_back({.weight = {}, .squared_epsilon = kOnes, .offset = {}, .ridge = {}});
      }
      RidgeBases& group = ridges_.back();
      // A ridge of any length is one of length 1 with another epsilon.
      const double length = base.ridge.norm();
      const std::size_t k = ridges++ % 4;
      group.weight.of[k] = base.weight;
      group.squared_epsilon.of[k] = std::pow(base.epsilon / (length * length), 2);
      group.offset.of[k] = base.ridge.dot(base.center) / length;
      const Eigen::Vector3d ridge = to_pressing * base.ridge / length;
      for (std::size_t i = 0; i < 3; ++i)
        group.ridge[i].of[k] = ridge[static_cast<Eigen::Index>(i)];
    } else {
      if (isotropic % 4 == 0)
        isotropic_.push_back({.weight = {}, .squared_epsilon = kOnes, .center = {}});
      IsotropicBases& group = isotropic_.back();
      const std::size_t k = isotropic++ % 4;
      group.weight.of[k] = base.weight;
      group.squared_epsilon.of[k] = base.epsilon * base.epsilon;
      const Eigen::Vector3d center = to_pressing * base.center;
      for (std::size_t i = 0; i < 3; ++i)
        group.center[i].of[k] = center[static_cast<Eigen::Index>(i)];
    }
  }
  range.isotropic_end = static_cast<int>(isotropic_.size());
  range.ridge_end = static_cast<int>(ridges_.size());
  ranges_.push_back(range);

  std::array<double, PlaceField::kConstants>& c = constants_.emplace_back();
  Eigen::Matrix3d::Map(c.data() + packed::kPressing) = pressing;
  Eigen::Vector3d::Map(c.data() + packed::kCone) = contact.frame.col(2);
  Eigen::Vector3d::Map(c.data() + packed::kPosition) = contact.position;
  Eigen::Vector3d::Map(c.data() + packed::kAxis) = contact.friction_axis;
  c[packed::kFriction] = contact.friction;
  c[packed::kLoadExponent] = contact.load_exponent;
  if (contact.compliance) {
    const ContactCompliance& given = *contact.compliance;
    Compliance::Map(c.data() + packed::kValues) = given.values;
    const double root =
        std::sqrt(given.values[3] * given.values[5] - given.values[4] * given.values[4]);
    c[packed::kRoot] = root;
    c[packed::kInverseRoot] = 1 / root;
    c[packed::kInverseDepth] = 1 / given.values[2];
    Eigen::Matrix<double, 6, 5, Eigen::RowMajor>::Map(c.data() + packed::kTrend) = given.trend;
  }
  Lanes at_zero;
  const std::array<double, 3> zero{};
  packed::evaluate_bases({isotropic_.data(), ridges_.data(), ranges_.data()},
                         static_cast<int>(ranges_.size()) - 1, zero.data(), at_zero);
  for (std::size_t i = 0; i < 3; ++i) c[packed::kGradientAtZero + i] = at_zero.of[i];
  c[packed::kEnergyAtZero] = at_zero.of[3];
}

// Gathers the constants of the contacts, unless they are there already.
void PackedField::select(const geometry::ContactWeights& weights,
                         PlaceField& place) const noexcept {
  const auto count = static_cast<std::size_t>(weights.count);
  // A loop of its own: std::equal calls memcmp, which takes longer for so few contacts.
  bool same = place.owner == id_ && place.count == weights.count;
  for (std::size_t k = 0; same && k < count; ++k) same = place.contacts[k] == weights.contacts[k];
  if (same) return;
  place.owner = id_;
  place.friction_force = friction_force_;
  place.count = weights.count;
  for (std::size_t k = 0; k < 4 * ((count + 3) / 4); ++k) {
    const int contact = weights.contacts[k < count ? k : 0];
    place.contacts[k] = contact;
    const auto& from = constants_[static_cast<std::size_t>(contact)];
    for (std::size_t i = 0; i < from.size(); ++i) place.constants[k / 4][i].of[k % 4] = from[i];
  }
}

// The place as `BlendedField` has it.
void PackedField::copy_blend(const geometry::SurfacePoint& point,
                             PlaceField& place) const noexcept {
  const Blend at = blended_.blend(point);
  place.friction = at.friction;
  place.load_exponent = at.load_exponent;
  place.cone_axis = at.frame.col(2);
  place.friction_axis = at.friction_axis;
  for (std::size_t k = 0; k < 4 * ((static_cast<std::size_t>(place.count) + 3) / 4); ++k) {
    const bool counts = k < static_cast<std::size_t>(place.count);
    Eigen::Matrix3d to_local = Eigen::Matrix3d::Zero();
    if (counts) {
      to_local = local_to_pressing_[static_cast<std::size_t>(place.contacts[k])] *
                 at.warps[k].displacement * at.field_frame.transpose();
    }
    for (std::size_t i = 0; i < 9; ++i) {
      place.to_local[k / 4][i].of[k % 4] =
          to_local(static_cast<Eigen::Index>(i / 3), static_cast<Eigen::Index>(i % 3));
    }
    place.scale[k / 4].of[k % 4] = counts ? at.contacts.weights[k] * at.warps[k].energy : 0;
  }
}

void PackedField::move_to(const geometry::SurfacePoint& point, const Eigen::Vector3d& position,
                          PlaceField& place) const noexcept {
  const geometry::ContactWeights weights = blended_.weights(point);
  select(weights, place);
  if (weights.count == 0) return;
  bool known = by_compliance_;
  std::array<Lanes, PlaceField::kPacks> in_lanes{};
  for (std::size_t k = 0; k < static_cast<std::size_t>(weights.count); ++k) {
    in_lanes[k / 4].of[k % 4] = weights.weights[k];
    known = known && has_compliance_[static_cast<std::size_t>(weights.contacts[k])] != 0;
  }
  if (!known || !packed::blend_places(position.data(), reach_, in_lanes.data(), place))
    copy_blend(point, place);
}

FieldForce PackedField::force(const PlaceField& place,
                              const Eigen::Vector3d& displacement) const noexcept {
  if (!displacement.allFinite() || place.owner != id_) return {};
  Lanes result;
  packed::evaluate(place, {isotropic_.data(), ridges_.data(), ranges_.data()}, displacement.data(),
                   result);
  return {{result.of[0], result.of[1], result.of[2]}, result.of[3]};
}

FieldForce PackedField::force(const PlaceField& place, const Eigen::Vector3d& displacement,
                              const DelayedDisplacements& delayed) const noexcept {
  FieldForce sum = force(place, displacement);
  for (std::size_t i = 0; i < rate_.size(); ++i) {
    const FieldForce part = force(place, displacement - delayed.of[i]);
    sum.force += rate_[i].share * part.force;
    sum.energy += rate_[i].share * part.energy;
  }
  return sum;
}

FrictionParts friction_parts(const PlaceField& at, const Eigen::Vector3d& force) noexcept {
  FrictionParts parts;
  parts.normal = force.dot(at.cone_axis);
  parts.tangential = (force - parts.normal * at.cone_axis).norm();
  parts.excess = parts.tangential -
                 friction_limit(at.friction, at.load_exponent, at.friction_force, parts.normal);
  return parts;
}

}  // namespace palpate::haptics
