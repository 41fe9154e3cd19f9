// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "palpate/geometry/deformation_graph.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Writes the nodes of a deformation graph where their motions put them, as points (.ply), each
/// with its motion: columns of the 3 x 4 matrix are the properties m00, m10, m20, m01, ..., m23.
/// What is read back has the same bits.
/// \throws OutputError.
void write_node_motions(const fs::path& path, const geometry::DeformationGraph& graph,
                        const std::vector<Eigen::Isometry3d>& motions);

/// Reads the motions again, one for each of `nodes`.
/// \throws FileError if the file is missing or broken, or holds the motions of another graph.
[[nodiscard]] std::vector<Eigen::Isometry3d> read_node_motions(const fs::path& path,
                                                               Eigen::Index nodes);

}  // namespace palpate::apps
