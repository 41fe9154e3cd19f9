// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// The kind of a pair of displacement and force.
enum class PairKind {
  settled,           ///< the mean position of a group under its normal force alone
  held,              ///< a sample that held, within the boundary
  friction_boundary  ///< one that held and is marked `on_friction_boundary`
};

/// Pairs of displacement and force at one contact, to which a force field is fitted.
struct ForceSamples {
  Eigen::Matrix3Xd displacements;  ///< [mm] 3 x N, tool position minus contact position
  Eigen::Matrix3Xd forces;         ///< [N] 3 x N, of the tool on the object
  std::vector<PairKind> kinds;     ///< N
  /// [mm] noise of each component of a displacement b - a + m - c, estimated from how far the
  /// positions `a` of a group scatter in the direction in which they scatter least; not known if no
  /// group has 4 positions.
  ///
  /// The estimate contains errors that a and b of one sample share, which cancel in b - a, and
  /// lacks the error of b. The positions `a` alone cannot tell the two apart. On a stretched sheet
  /// (0.02 mm of position, 0.02 mm along the surface, 0.01 N) they balance, 0.028 mm. On a rigid
  /// object the estimate is too small by a factor of up to sqrt(2), which kMaxChi2 allows for.
  std::optional<double> displacement_noise = std::nullopt;
  int degrees_of_freedom = 0;  ///< of that estimate, in each component
};

/// [mm] the estimates of several contacts combined, weighted by their degrees of freedom; nothing
/// if no contact has one.
[[nodiscard]] std::optional<double> pooled_displacement_noise(
    std::span<const ForceSamples> contacts);

/// A position `a` is an outlier of its group if the group has at least 4 positions and the distance
/// of `a` to their median, taken component by component, is more than this many times the median
/// distance. Normal noise that is the same in all directions makes 5 in 10^4 positions of a group
/// of 4 an outlier, and 1 in 10^5 of a group of 8; noise in one direction alone 1 in 100 of a group
/// of 8, and 5 in 10^5 of large groups. In a group of 3 noise alone would make one in 200 an
/// outlier.
inline constexpr double kOutlierRatio = 6;

/// Returns true if the tool moved on from the place at which the normal force alone held it.
[[nodiscard]] bool has_tangential_stage(const probing::Sample& sample);

/// Realigns the samples of one contact (thesis 5.2), in the world frame. Samples of other contacts
/// are ignored.
///
/// All tool positions `a` of a group belong to the same normal force. Their mean m is the best
/// estimate of that position and makes one pair (m - c, mean component of the forces along the
/// normal). A sample whose `a` is an outlier enters neither mean. Every sample that held makes a
/// further pair (b - a + m - c, p); of a sample that slipped only `a` is used. A sample without a
/// tangential stage makes none: it would count twice. If no sample of a group has one, the
/// group's pair has the mean of their whole forces. Pairs are ordered by group, then as the
/// samples are.
[[nodiscard]] ForceSamples realign(const probing::Contact& contact,
                                   std::span<const probing::Sample> samples);

}  // namespace palpate::haptics
