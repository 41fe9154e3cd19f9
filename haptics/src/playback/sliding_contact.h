// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/haptics/packed_field.h"
#include "playback/surface_walk.h"

namespace palpate::haptics {

// The friction axis is used where the cosine between it and the inward normal is at least this (75
// degrees); nearer to the tangent plane the line along it would run far away.
inline constexpr double kMinAxisCosine = 0.26;

/// A contact with the force at it.
struct SlidingContact {
  SurfacePlace at;
  FieldForce force;
  FrictionParts parts;
  bool off_border = false;  ///< the contact still slips, off the border of the surface
  /// A root was found near the start, whether or not there is energy to go there. One far away says
  /// nothing about a tool that has left the object.
  bool found_near = true;
};

/// If the object would pull the tool because it returns more slowly, lets the delayed displacements
/// follow until it does not. u - z shrinks to the largest part of itself at which the normal force
/// is not negative, in halvings; at 0 the force is that of the field. Real-time safe.
/// \param place of `contact`.
void let_follow(const PackedField& field, const PlaceField& place, const Eigen::Vector3d& tool,
                DelayedDisplacements& delayed, SlidingContact& contact) noexcept;

/// [N mm] Energy that the user must have put in before the middle of a tick if the contact goes
/// there. \param moved [mm] by the tool in this tick.
[[nodiscard]] double cost_of(const SlidingContact& contact, const Eigen::Vector3d& moved) noexcept;

/// Vector from a contact to where the friction axis through the tool meets the tangent plane: the
/// line of Eq 5.19 for t = 0 .. 1. An axis more than 75 degrees from the inward normal is replaced
/// by the normal.
[[nodiscard]] Eigen::Vector3d slip_line(const Eigen::Vector3d& friction_axis,
                                        const Eigen::Vector3d& normal,
                                        const Eigen::Vector3d& displacement) noexcept;

}  // namespace palpate::haptics
