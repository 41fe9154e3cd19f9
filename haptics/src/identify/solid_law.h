// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "identify/parameter_search.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/finite_element_specimen.h"

namespace palpate::haptics {

/// The parameters of a solid: logarithms of what the shear modulus of each region and the ratio of
/// bulk to shear moduli are multiplied by, and the factor of the moves of supports, if any moves.
[[nodiscard]] Eigen::Index solid_parameters(const probing::DeformableBody& body);
[[nodiscard]] bool has_moves(const probing::DeformableBody& body);
[[nodiscard]] probing::DeformableBody with_parameters(probing::DeformableBody body,
                                                      const Eigen::VectorXd& parameters);

/// Called after each equilibrium, from several threads. An exception that it throws passes through.
using EquilibriumDone = std::function<void()>;

/// The law of a solid whose contacts are `contacts`. It keeps references to both. Its only start is
/// as given.
[[nodiscard]] ParametricLaw solid_law(const probing::FiniteElementObject& object,
                                      std::span<const probing::Contact> contacts,
                                      EquilibriumDone done);

/// [mm] Displacements under the forces of pairs, where there is an equilibrium.
/// \throws InvalidInput, SolverError as `ProbedSolid` does.
[[nodiscard]] std::vector<std::optional<Eigen::Vector3d>> solid_displacements(
    const probing::FiniteElementObject& object, std::span<const probing::Contact> contacts,
    std::span<const Pair> pairs, const EquilibriumDone& done);

}  // namespace palpate::haptics
