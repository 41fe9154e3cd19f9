// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <vector>

#include "palpate/geometry/mesh_io.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// A mesh of a sequence.
struct MotionFrame {
  fs::path file;
  double time = 0;  ///< [s] or [frames], since the first one
};

/// Meshes with the same triangles, in the order of time.
struct MotionSequence {
  std::vector<MotionFrame> frames;
  bool has_seconds = false;  ///< true if the times are in seconds, not frames
};

/// The meshes of a folder. Their names are times, or end with the numbers of frames, so that lost
/// frames leave gaps; otherwise the meshes are counted in the order of their names.
/// \throws FileError if there are none.
[[nodiscard]] MotionSequence motion_sequence(const fs::path& folder);

/// [1/s] Returns the divisor that converts the times of a sequence to seconds: 1 if they are in
/// seconds, otherwise `rate`.
/// \throws InvalidInput if they are in seconds, and --rate was given as well.
[[nodiscard]] std::optional<double> frame_rate(const MotionSequence& sequence,
                                               const std::optional<double>& rate);

/// Reads a mesh of a sequence.
/// \throws FileError also if it does not have the triangles of `reference`.
[[nodiscard]] geometry::MeshFile read_motion_frame(const fs::path& file,
                                                   const geometry::TriangleMesh& reference,
                                                   const geometry::ReadOptions& options = {});

}  // namespace palpate::apps
