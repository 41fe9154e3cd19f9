// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "palpate/geometry/mesh_io.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// The options of `palpate export --glb` of a folder.
struct AnimationCall {
  fs::path folder, output;
  std::optional<double> rate;  ///< [Hz] frames, if their names are no times
  int every = 1;               ///< only every Nth frame
  geometry::ReadOptions meshes;
};

/// Writes meshes with the same triangles, as `track` writes them, as one animated surface.
/// \returns what was written, in words: frames, duration, size, and frames that `track` lost.
/// \throws FileError if a file is damaged or has other triangles; InvalidInput if fewer than two
/// meshes are taken, or `rate` is given and the names are times.
std::string write_animation(const AnimationCall& call);

}  // namespace palpate::apps
