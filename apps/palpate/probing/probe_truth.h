// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/probing/known_forces.h"
#include "palpate/probing/specimen.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Names of the files in a folder of `write_truth`.
inline constexpr const char* kTruthSurface = "surface.ply";
inline constexpr const char* kTruthQueries = "queries.csv";

/// Writes the surface of a simulated object and known forces on it.
/// \throws InvalidInput if no place is so far from the border, SolverError if a force has no
/// equilibrium, or OutputError.
void write_truth(const fs::path& folder, const probing::Specimen& specimen,
                 const probing::KnownForceOptions& options = {});

}  // namespace palpate::apps
