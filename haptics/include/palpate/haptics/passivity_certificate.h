// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// Where passivity is asked for: the ball of all displacements of at most this length. It contains
/// the convex hull of the displacements it is made from, does not depend on the frame, and with a
/// place it contains the straight way there from zero.
struct ReachableVolume {
  double radius = 0;  ///< [mm] >= 0
};

/// How far beyond the longest measured displacement a tool is expected: a factor.
inline constexpr double kReachFactor = 1.1;

/// kReachFactor times the longest of the displacements, 3 x N [mm].
[[nodiscard]] ReachableVolume reachable_volume(
    const Eigen::Ref<const Eigen::Matrix3Xd>& displacements);

struct CertificateOptions {
  /// The certificate also holds for every field whose numbers differ from this one's by at most
  /// this fraction: weight and epsilon of themselves, a centre of its distance from zero plus
  /// epsilon, a ridge of 1. In [0, 1e-3]. 1e-6 covers a turn of the frame and the kFieldDigits
  /// digits of a stored field.
  double number_tolerance = 1e-6;
  double energy_tolerance = 0;  ///< [N mm] >= 0: an energy above minus this counts as passive
  int max_cells = 100000;       ///< >= 1; gives up after so many
};

enum class Passivity {
  convex,     ///< no weight is negative: energy >= 0 everywhere, by construction
  certified,  ///< energy >= 0 in all the reachable volume: proven
  violated,   ///< the energy at `weakest` is below zero: proven
  undecided   ///< neither was proven
};

struct PassivityCertificate {
  Passivity passivity = Passivity::undecided;
  ReachableVolume volume;
  int cells = 0;  ///< that were looked at
  /// [mm] where the energy, as a multiple of the squared displacement, is lowest, as far as seen
  Eigen::Vector3d weakest = Eigen::Vector3d::Zero();
  /// [N/mm] 2 p(x) / |x|^2 there, p the energy: the margin. A convex field is not looked at: 0.
  double weakest_stiffness = 0;
};

/// Proves or disproves that the energy of a field is nowhere in the volume below its value at zero
/// displacement: that a user who moves the tool from zero to anywhere in it puts work in, whatever
/// the way (thesis 5.3.1.1, "passive").
///
/// Near zero, up to a radius where the third derivative cannot yet undo it, the stiffness at zero
/// proves it; the rest is cut into cubes, and cubes into eight, until a Taylor bound of second
/// order around their centre proves each (branch and bound). All numbers carry bounds of their
/// rounding errors, so proofs hold for real numbers. A field whose stiffness at zero is singular
/// with a direction that no base sees, or that misses semi-definiteness by rounding, can end
/// `undecided` unless `energy_tolerance` > 0 or all weights are >= 0.
/// \throws InvalidInput on a field that `check_force_field` refuses, a radius that is not finite
/// and >= 0, or an option out of its range.
[[nodiscard]] PassivityCertificate certify_passivity(const ForceField& field,
                                                     const ReachableVolume& volume,
                                                     const CertificateOptions& options = {});

/// Whether it says that the field is passive: `convex` or `certified`.
[[nodiscard]] bool is_passive(const PassivityCertificate& certificate);

/// In a word, for reports: "convex", "certified", ...
[[nodiscard]] const char* to_string(Passivity passivity);

}  // namespace palpate::haptics
