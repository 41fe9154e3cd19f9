// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>

#include "palpate/haptics/contact_motion.h"
#include "palpate/haptics/packed_field.h"
#include "playback/surface_walk.h"

namespace palpate::haptics {

struct SlipSearchOptions {
  double tolerance = 2e-4;  ///< [N] > 0; a place is found where ||f_T| - mu f_N| is at most this
  /// [N mm] The contact only moves to places where stored energy less half of f . `moved` is at
  /// most this, or what it is at the start if that is more.
  double budget = std::numeric_limits<double>::infinity();
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();  ///< [mm] by the tool in this tick
  DelayedDisplacements delayed = {};                ///< stay as they are in the search
};

/// A contact with the force at it.
struct SlidingContact {
  SurfacePlace at;
  FieldForce force;
  FrictionParts parts;
  bool off_border = false;  ///< the contact still slips, off the border of the surface
  bool found = true;        ///< a root was found, whether or not there is energy to go there
};

/// Where the object would pull the tool because it returns more slowly: lets the delayed
/// displacements follow until it does not. u - z shrinks to the largest part of itself at which the
/// normal force is not negative, in halvings; at 0 the force is that of the field. Real-time safe.
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

/// Finds where a slipping contact moves to (Eq 5.17): a root of |f_T| - mu f_N.
///
/// It walks along the section of the surface with the plane of tool and friction axis (Eq 5.19),
/// with a bracketed secant that begins with the slope of the last slip. On the far side of the cone
/// |f_T| counts as negative, so that the bracket holds the near side. Where the section has no
/// root, the contact follows f_T itself, by Broyden's method in two dimensions; so it does at once
/// after a slip that ended so, with the Jacobian of that one. If that does not find one either, as
/// after jumps, the search begins again at the point nearest to the tool, and then goes down |f_T|
/// - mu f_N itself from the best place so far. At most 30 evaluations until then, 71 in all, and 3
/// for the energy. Real-time safe.
/// \param start where |f_T| exceeds mu f_N.
/// \param place of `start`; afterwards of the result.
/// \param memory of the last slip; afterwards of this one.
[[nodiscard]] SlidingContact search_slip(const PackedField& field, const SurfaceWalk& surface,
                                         const SlidingContact& start, const Eigen::Vector3d& tool,
                                         const SlipSearchOptions& options, PlaceField& place,
                                         SlipMemory& memory) noexcept;

}  // namespace palpate::haptics
