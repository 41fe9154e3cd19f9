// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "identify/parameter_estimation.h"
#include "identify/solid_law.h"

namespace palpate::haptics {

/// The effect of a mesh of half the size of elements on some of the pairs. All vectors are of one
/// length.
struct MeshStudy {
  std::vector<std::size_t> pairs;           ///< indices
  std::vector<Eigen::Vector3d> difference;  ///< [mm] displacement on the finer mesh minus given one
};

/// Repeats at most `most` pairs, with large and small forces, at contacts far apart: the error of a
/// mesh depends on how large the touched area is. Those without an
/// equilibrium on one of the meshes are left out.
[[nodiscard]] MeshStudy study_mesh(const probing::FiniteElementObject& object,
                                   std::span<const probing::Contact> contacts,
                                   const std::vector<Pair>& pairs, std::size_t most,
                                   const EquilibriumDone& done);

/// RMS of each component of what a common factor of displacements leaves of the differences, over
/// the length of the displacement; 0 without pairs.
[[nodiscard]] double mesh_scatter(const MeshStudy& study, const std::vector<Pair>& pairs);

/// Returns the bias of the parameters of an estimate, whose scales are one, because its
/// displacements are those of the given mesh. The first `regions` are shear moduli: their shifts
/// are alike unless the study shows otherwise. Others are not shifted where `free` is false.
///
/// The largest error of meshes is a common factor of displacements, which whole displacements show
/// better than the short drags. Here they therefore have the same weight, relative to their length.
[[nodiscard]] Eigen::VectorXd mesh_shift(const MeshStudy& study, const std::vector<Pair>& pairs,
                                         const LawEstimate& found, const std::vector<bool>& free,
                                         Eigen::Index regions);

}  // namespace palpate::haptics
