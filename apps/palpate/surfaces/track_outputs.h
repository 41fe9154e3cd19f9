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

/// What is written for each range map, and where.
struct TrackOutputs {
  fs::path folder;
  std::string format = "ply";  ///< of the meshes
  bool pictures = false;
};

/// Name of the mesh of a range map, in the folder.
[[nodiscard]] std::string mesh_name(const TrackOutputs& outputs, const fs::path& range_map);

/// The file that keeps how the nodes moved, from which another run goes on.
[[nodiscard]] fs::path nodes_file(const TrackOutputs& outputs, const fs::path& range_map);

/// Whether all files of a frame are there; a lost one has none.
[[nodiscard]] bool has_outputs(const TrackOutputs& outputs, const TrackedFrame& frame);

/// Writes what the tracker found. The record of the frame has to be written after it.
/// \param colors of the vertices.
/// \throws OutputError if a file cannot be written.
void write_outputs(const TrackOutputs& outputs, const fs::path& range_map,
                   const geometry::Attributes& colors, const geometry::DeformationGraph& graph,
                   const geometry::TrackedSurface& found);

/// Reads how the nodes moved from such a file, a motion for each of `nodes`.
/// \throws FileError if the file is missing or broken, or holds the motions of another graph.
[[nodiscard]] std::vector<Eigen::Isometry3d> read_node_motions(const fs::path& path,
                                                               Eigen::Index nodes);

}  // namespace palpate::apps
