// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/haptics/force_field.h"

namespace palpate::haptics {

/// The volume in which passivity is required: the ball of all displacements up to a length. It
/// contains the convex hull of the displacements it is computed from, is independent of the frame,
/// and contains the straight line from zero to each of its points.
struct ReachableVolume {
  double radius = 0;  ///< [mm] >= 0
};

/// Ratio of the longest displacement expected in use to the longest measured one.
inline constexpr double kReachFactor = 1.1;

/// The ball of kReachFactor times the longest of the displacements, 3 x N [mm].
[[nodiscard]] ReachableVolume reachable_volume(
    const Eigen::Ref<const Eigen::Matrix3Xd>& displacements);

struct CertificateOptions {
  /// The certificate also holds for every field whose parameters differ by at most this relative
  /// tolerance: weight and epsilon relative to themselves, a centre relative to its distance from
  /// zero plus epsilon, a ridge relative to 1. In [0, 1e-3]. 1e-6 covers a rotation of the frame
  /// and storage with kFieldDigits digits.
  double number_tolerance = 1e-6;
  double energy_tolerance = 0;  ///< [N mm] >= 0: an energy above minus this counts as passive
  int max_cells = 100000;       ///< >= 1; the search stops after this many cells
};

enum class Passivity {
  convex,     ///< no weight is negative, so the energy is >= 0 everywhere
  certified,  ///< proven: the energy is >= 0 in the whole reachable volume
  violated,   ///< proven: the energy at `weakest` is below zero
  undecided   ///< neither was proven
};

struct PassivityCertificate {
  Passivity passivity = Passivity::undecided;
  ReachableVolume volume;
  int cells = 0;  ///< number of cells that were examined
  /// [mm] displacement with the lowest energy found, relative to the squared displacement
  Eigen::Vector3d weakest = Eigen::Vector3d::Zero();
  /// [N/mm] margin: 2 p(x) / |x|^2 at `weakest` for the energy p; 0 for a convex field, which is
  /// not examined.
  double weakest_stiffness = 0;
};

/// Proves or disproves that a field's energy is nowhere in the volume below its value at zero
/// displacement, that is, that moving the tool from zero to any place in it takes work on every
/// path (thesis 5.3.1.1, "passive").
///
/// Near zero, up to a radius within which the third derivative cannot outweigh it, the stiffness at
/// zero gives the proof. The rest is divided into cubes, which are subdivided until a second-order
/// Taylor bound around the centre gives the proof (branch and bound). All numbers have bounds for
/// rounding errors, so the proof holds for real numbers. A field can end `undecided` if its
/// stiffness at zero is singular with a direction that no base depends on, or misses
/// semi-definiteness by rounding, unless `energy_tolerance` > 0 or all weights are >= 0.
/// \throws InvalidInput if `check_force_field` rejects the field, the radius is not finite and >=
/// 0, or an option is outside its range.
[[nodiscard]] PassivityCertificate certify_passivity(const ForceField& field,
                                                     const ReachableVolume& volume,
                                                     const CertificateOptions& options = {});

/// Returns true if the field is passive: `convex` or `certified`.
[[nodiscard]] bool is_passive(const PassivityCertificate& certificate);

/// Name for reports: "convex", "certified", ...
[[nodiscard]] const char* to_string(Passivity passivity);

}  // namespace palpate::haptics
