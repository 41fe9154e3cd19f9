// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <string>
#include <vector>

#include "palpate/probing/acquisition.h"

namespace palpate::probing {

/// The reason why measurements are implausible. "Pressed": a force against the outward normal of
/// its contact moves the tool to the inner side of the contact, so that the work is positive.
enum class Implausibility {
  forces_reversed,   ///< forces along the normal, tool inside: those of the object on the tool
  normals_inwards,   ///< forces along the normal, and the tool on the side it points to
  tool_outside,      ///< forces against the normal, tool outside
  pulling_samples,   ///< single samples whose normal force is opposite to that of their contact
  outside_samples,   ///< single samples whose tool is on the other side than that of their contact
  exchanged_ends,    ///< tangential forces move the tool backwards, from `a` to `b`
  mixed_groups,      ///< the normal force differs within groups
  scattered_groups,  ///< `a` differs within groups
  length_units,      ///< tool positions do not scale as the contacts do
  distant_tool,      ///< the tool is far from its contact, or at another one
  length_scale,      ///< the object, or all displacements, have an unlikely size
  force_scale,       ///< forces have an unlikely size
  tilted_forces,     ///< forces that held are nearly tangential
  slips_reversed,    ///< samples that held have larger tangential forces than those that slipped
  slips_unrelated,   ///< slips have nothing to do with tangential forces
  all_slipped        ///< every sample slipped
};

/// "forces_reversed", "normals_inwards", ...
[[nodiscard]] const char* to_string(Implausibility kind);

struct Finding {
  Implausibility kind{};
  bool impossible = false;  ///< cannot be a measurement of an object; otherwise only suspicious
  std::string what;         ///< the problem and its place, with figures
  std::string right;        ///< the correct form
};

/// "WHAT; RIGHT".
[[nodiscard]] std::string message(const Finding& finding);

// Limits of `find_implausible`. Most are ratios, which depend on neither unit nor frame.

/// A sample contradicts its contact if its normal force, or its depth, has the other sign and at
/// least this share of the largest one there. Noise and a touch found late are well below.
inline constexpr double kOppositeShare = 0.5;
/// [mm] The side of a tool that is nearer to its contact is not judged unless it changes with the
/// force: detectors find a touch this late.
inline constexpr double kTouchError = 1;
/// Standard deviation of the normal force within groups, relative to the root mean square of all
/// normal forces: suspicious above the first (the noise of a usable sensor), impossible above the
/// second (two levels, one twice the other, taken for one have 0.32).
inline constexpr double kSuspiciousGroupScatter = 0.1;
inline constexpr double kImpossibleGroupScatter = 0.3;
/// Standard deviation of `a` within groups, relative to the root mean square of all displacements,
/// above which it is suspicious, if it also exceeds ten times the position noise of an arm [mm].
inline constexpr double kSuspiciousPositionScatter = 0.3;
inline constexpr double kPositionScatter = 0.2;
/// Spread of the tool positions under the least force of each contact, relative to that of the
/// contacts. About 1; pressing a ball from all sides by half its radius gives 0.5. Other units than
/// those of the contacts give at most 0.1 or at least 10, displacements in place of positions at
/// most 0.4 on usual objects.
inline constexpr double kLeastSpread = 0.4;
inline constexpr double kLargestSpread = 8;
/// Distance from tool to contact relative to the spread of the contacts: suspicious, impossible.
inline constexpr double kSuspiciousDistance = 4;
inline constexpr double kImpossibleDistance = 100;
/// A tool is at another contact if, under the least force, it is further from its own than
/// `kTouchError` and than this many times the distance from another. A press is along the normal,
/// away from all others.
inline constexpr double kTimesNearer = 2;
/// [mm] Extent of the contacts: below the reach of a finger tip, beyond that of any arm.
inline constexpr double kSmallestExtent = 1;
inline constexpr double kLargestExtent = 5000;
/// [mm] A median displacement below this is within the noise of arms (thesis 5.2: 0.02 mm).
inline constexpr double kSmallestDisplacement = 0.02;
/// A tool stands still if it moves by no more than this, relative to the coordinates of the
/// contacts: the rounding of nine digits.
inline constexpr double kStandstill = 1e-9;
/// [N] Largest force of all: below what force sensors resolve, beyond what soft objects are probed
/// with (a haptic arm has 3 N, 3 N in grams are 306).
inline constexpr double kSmallestForce = 0.02;
inline constexpr double kLargestForce = 200;
/// Tangential over normal force that held: rubber has 1 to 4.
inline constexpr double kLargestFriction = 8;
/// Probability that a slipped sample has a larger tangential force, relative to its normal force,
/// than one that held at the same contact. 1/2: slips are unrelated to forces; near 0: reversed.
inline constexpr double kUnrelatedSlips = 0.6;
inline constexpr double kReversedSlips = 0.25;
/// Fewer pairs of a slipped and a held sample are not conclusive.
inline constexpr double kFewestSlipPairs = 25;

/// Checks consequences of the meaning of contacts and samples, for any object: signs of forces and
/// sides, groups, units, slips. A finding is suspicious if it holds for at most half of the
/// contacts, and impossible if it holds for more, unless it concerns the absolute scale. Findings
/// come in the order of `Implausibility`.
[[nodiscard]] std::vector<Finding> find_implausible(const CheckedAcquisition& acquisition);

/// Forces have one direction if none deviates from their mean direction by more than this tangent
/// (6 degrees): the error of a sensor and its mounting.
inline constexpr double kOneDirection = 0.1;

/// Ids of the contacts whose samples that held have forces of one direction, so that nothing was
/// measured of the stiffness across it.
[[nodiscard]] std::vector<long long> probed_in_one_direction(const CheckedAcquisition& acquisition);

}  // namespace palpate::probing
