// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>

#include "palpate/haptics/contact_motion.h"
#include "palpate/haptics/packed_field.h"
#include "playback/sliding_contact.h"
#include "playback/surface_walk.h"

namespace palpate::haptics {

struct SlipSearchOptions {
  /// [N] > 0; a place is found where ||f_T| - mu f_N| is at most this
  double tolerance = std::numeric_limits<double>::quiet_NaN();
  /// [N mm] The contact only moves to places where stored energy less half of f . `moved` is at
  /// most this, or what it is at the start if that is more.
  double budget = std::numeric_limits<double>::infinity();
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();  ///< [mm] by the tool in this tick
  DelayedDisplacements delayed = {};                ///< stay as they are in the search
};

/// Finds where a slipping contact moves to (Eq 5.17): a root of |f_T| - mu f_N with f_N >= 0.
///
/// It walks along the section of the surface with the plane of tool and friction axis (Eq 5.19),
/// with a bracketed secant that begins with the slope of the last slip. On the far side of the cone
/// |f_T| counts as negative, so that the bracket holds the near side. If the section has no root,
/// the contact follows f_T itself, by Broyden's method in two dimensions; it does so at once if the
/// last slip ended in this way, with the Jacobian of that one: at most 30 evaluations until then.
/// If that does not find a root either, as after jumps and across creases, the search starts again
/// at the point nearest to the tool. Then it goes down the part of f_T beyond the cone along the
/// surface itself, from the best place so far, the nearest point, the start, and the best five of
/// 24 places around the nearest point, of 24 further away, and of 48 as far away as contacts: at
/// most 12 steps of 7 evaluations, and 12 once a place holds. Real-time safe.
/// \param start where |f_T| exceeds mu f_N.
/// \param place of `start`; afterwards of the result.
/// \param memory of the last slip; afterwards of this one.
[[nodiscard]] SlidingContact search_slip(const PackedField& field, const SurfaceWalk& surface,
                                         const SlidingContact& start, const Eigen::Vector3d& tool,
                                         const SlipSearchOptions& options, PlaceField& place,
                                         SlipMemory& memory) noexcept;

}  // namespace palpate::haptics
