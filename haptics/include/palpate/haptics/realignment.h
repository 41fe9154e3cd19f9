// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// What a pair of displacement and force stands for.
enum class PairKind {
  settled,           ///< the mean position of a group under its normal force alone
  held,              ///< a sample that held, within the boundary
  friction_boundary  ///< one that held and is marked `on_friction_boundary`
};

/// Pairs of displacement and force at one contact, what a force field is fitted to.
struct ForceSamples {
  Eigen::Matrix3Xd displacements;  ///< [mm] 3 x N, tool position minus contact position
  Eigen::Matrix3Xd forces;         ///< [N] 3 x N, of the tool on the object
  std::vector<PairKind> kinds;     ///< N
  /// [mm] noise of each component of a displacement b - a + m - c; NaN if no group has 4 positions.
  /// It is how far the positions `a` of a group scatter where they scatter least. That holds what
  /// is the same for b and a of one sample and so cancels in b - a (where the tool touches, the
  /// error of the force on a soft object), and lacks the error of b. From `a` alone the two cannot
  /// be told apart. On a stretched sheet (0.02 mm of position, 0.02 mm along the surface, 0.01 N)
  /// they balance, 0.028 mm; on a rigid object it is too small by a factor of up to sqrt(2), which
  /// the greatest chi^2 that a fit counts as explained allows for.
  double displacement_noise = std::numeric_limits<double>::quiet_NaN();
  int degrees_of_freedom = 0;  ///< of that estimate, in each component
};

/// [mm] the estimates of some contacts as one, weighted by their degrees of freedom; none if they
/// have none.
[[nodiscard]] std::optional<double> pooled_displacement_noise(
    std::span<const ForceSamples> contacts);

/// A position `a` is an outlier of its group iff its distance to their median, component by
/// component, exceeds the median distance so many times, and the group has at least 4 positions: of
/// 3, noise alone would make one in 200 an outlier. Normal noise that is the same in all directions
/// makes 5 in 10^4 positions of a group of 4 one, 1 in 10^5 of 8; noise in one direction alone
/// makes 1 in 100 of 8, 5 in 10^5 of large groups.
inline constexpr double kOutlierRatio = 6;

/// Realigns the samples of one contact (thesis 5.2); world frame.
///
/// Within each group all tool positions `a` belong to the same normal force, so their mean m is the
/// best estimate of it: it makes one pair (m - c, mean component of the forces along the normal). A
/// sample whose `a` is an outlier enters neither mean.
/// Every sample that held makes a further pair (b - a + m - c, p). Of a sample that slipped only
/// `a` is used. Samples of other contacts are left out. Pairs come by ascending group, then in the
/// order of the samples.
[[nodiscard]] ForceSamples realign(const probing::Contact& contact,
                                   std::span<const probing::Sample> samples);

}  // namespace palpate::haptics
