// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/probing/specimen.h"

namespace palpate::apps {

/// Names of the files in a folder of `write_truth`.
inline constexpr const char* kTruthSurface = "surface.ply";
inline constexpr const char* kTruthQueries = "queries.csv";

struct TruthOptions {
  int queries = 400;     ///< number of known forces
  double margin = 8;     ///< [mm] least distance of their places from the border
  double max_force = 3;  ///< [N] largest of the forces
  unsigned seed = 1;     ///< of the random places and forces
};

/// Writes the surface of a simulated object and known forces on it.
/// \throws InvalidInput if no place is so far from the border, or OutputError.
void write_truth(const std::filesystem::path& folder, const probing::Specimen& specimen,
                 const TruthOptions& options = {});

}  // namespace palpate::apps
