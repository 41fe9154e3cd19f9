// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <vector>

#include "palpate/geometry/mesh_io.h"

namespace palpate::geometry {

/// A surface that moves: N frames with the same triangles.
struct MeshAnimation {
  MeshFile first;  ///< V vertices, at times[0]
  /// [mm] N - 1 of 3 x V: how far the vertices of each further frame are from those of `first`.
  std::vector<Eigen::Matrix3Xf> displacements;
  std::vector<double> times;  ///< [s] N, ascending, >= 0
};

/// Writes a binary glTF 2.0 file that Blender, three.js and other viewers play: the mesh `first`
/// with a morph target for each further frame, and an animation of their weights. Between two
/// frames, vertices move along straight lines. As `write_mesh_file` does, it writes metres, keeps
/// the axes, and rounds to float: vertices are correct to the last digit of their coordinates.
///
/// Vertices have the colours of `first`. Other attributes, normals and textures are left out;
/// viewers then compute normals that follow the motion. Normals in the file would double its size.
///
/// The file has 12 bytes per vertex and further frame, 12 per vertex (28 with colours), 12 per
/// triangle and 4 per pair of frames; at most 4 GB. Targets are dense: sparse ones take 16 bytes
/// per vertex that moves. Viewers hold all targets in memory, and many evaluate all of them for
/// each picture; WebGL promises no more than 256, so longer sequences should be thinned out.
/// \throws InvalidInput if there is only one frame, sizes differ, times do not increase (as float),
/// a number is not finite or beyond the range of float, `first` is not valid, the file would be too
/// large, or the extension is not .glb.
/// \throws OutputError if the file cannot be written.
void write_mesh_animation(const std::filesystem::path& path, const MeshAnimation& animation);

}  // namespace palpate::geometry
