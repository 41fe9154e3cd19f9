// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "palpate/geometry/attribute.h"
#include "palpate/geometry/deformation_graph.h"
#include "palpate/geometry/surface_tracker.h"
#include "shared/aliases.h"
#include "surfaces/track_record.h"

namespace palpate::apps {

/// The outputs for each range map, and their folder.
struct TrackOutputs {
  fs::path folder;
  std::string format = "ply";  ///< of the meshes
  bool pictures = false;
};

/// Name of the mesh of a range map, in the folder.
[[nodiscard]] std::string mesh_name(const TrackOutputs& outputs, const fs::path& range_map);

/// The file with the motions of the nodes, from which another run continues.
[[nodiscard]] fs::path nodes_file(const TrackOutputs& outputs, const fs::path& range_map);

/// Returns true if all files of a frame exist; a lost one has none.
[[nodiscard]] bool has_outputs(const TrackOutputs& outputs, const TrackedFrame& frame);

/// Writes the result of the tracker. The record of the frame must be written after it.
/// \param colors of the vertices.
/// \throws OutputError if a file cannot be written.
void write_outputs(const TrackOutputs& outputs, const fs::path& range_map,
                   const geometry::Attributes& colors, const geometry::DeformationGraph& graph,
                   const geometry::TrackedSurface& found);

/// Reads the motions of the nodes from such a file, one for each of `nodes`.
/// \throws FileError if the file is missing or broken, or holds the motions of another graph.
[[nodiscard]] std::vector<Eigen::Isometry3d> read_node_motions(const fs::path& path,
                                                               Eigen::Index nodes);

}  // namespace palpate::apps
