// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>

#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// Pairs of displacement and force at one contact, what a force field is fitted to.
struct ForceSamples {
  Eigen::Matrix3Xd displacements;  ///< [mm] 3 x N, tool position minus contact position
  Eigen::Matrix3Xd forces;         ///< [N] 3 x N, of the tool on the object
  /// [mm] standard deviation of each component of a displacement, estimated from how the positions
  /// `a` of a group scatter; NaN if no group has enough. The applied force varies too and moves a
  /// soft object more than the tool's position is in error: what counts in each group is the
  /// direction in which they scatter least. (A realigned pair has the position noise of b and of a,
  /// but not what both share: where the tool touched, and most of the force's error.)
  double displacement_noise = std::numeric_limits<double>::quiet_NaN();
  int degrees_of_freedom = 0;  ///< of that estimate, in each component
};

/// [mm] the estimates of some contacts as one, weighted by their degrees of freedom; none if they
/// have none.
[[nodiscard]] std::optional<double> pooled_displacement_noise(
    std::span<const ForceSamples> contacts);

/// A position `a` is an outlier of its group iff its distance to their mean exceeds the median
/// distance so many times: 1 in 10^5 of a normal distribution in one direction, fewer in three.
inline constexpr double kOutlierRatio = 6;

/// Realigns the samples of one contact (thesis 5.2); world frame.
///
/// Within each group all tool positions `a` belong to the same normal force, so their mean m is the
/// best estimate of it (an `a` that is off by more than kOutlierRatio times the median distance
/// is left out of the mean): it makes one pair (m - c, component of the force along the normal).
/// Every sample that held makes a further pair (b - a + m - c, p). Of a sample that slipped only
/// `a` is used. Samples of other contacts are left out. Pairs come by ascending group, then in the
/// order of the samples.
[[nodiscard]] ForceSamples realign(const probing::Contact& contact,
                                   std::span<const probing::Sample> samples);

}  // namespace palpate::haptics
