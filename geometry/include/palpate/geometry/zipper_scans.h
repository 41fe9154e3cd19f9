// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "palpate/geometry/merge_scans.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct ZipperScansOptions {
  /// Two scans see the same place of the object iff they are within this many point spacings of
  /// each other there and their front sides face the same half-space; > 0, finite. More than the
  /// steps that noise and registration leave between scans, less than the object is thick.
  double reach = 2;
};

/// A measured point.
struct ScanVertex {
  int scan = -1;
  int vertex = -1;
};

struct ZipperedScans {
  TriangleMesh mesh;               ///< in the frame of the object
  std::vector<ScanVertex> source;  ///< of each vertex, so that attributes can follow
  double spacing = 0;              ///< [mm] median edge length of the scans
  int dropped = 0;                 ///< triangles of scans where another scan is
  int seam = 0;                    ///< triangles between vertices of different scans
};

/// One surface, open as the scans are, out of pieces of registered scans that overlap, after Turk
/// and Levoy 1994: where two scans see the same place that one is kept which is farther from its
/// own border there, by more than a few spacings the later one (so a silhouette, where a camera
/// sees badly, gives way), and the gap between the pieces, an edge or two wide, is closed with
/// triangles between their vertices. Unlike there, no triangle is clipped and no vertex moved:
/// every vertex is a measured one, and away from the seams the triangles are those of the scans.
/// So nothing is averaged: a step between scans stays as a steep seam. `merge_scans` averages.
///
/// The scans are added in their order, each to the surface of those before. The surface is oriented
/// and manifold. Scans should be about equally dense; a hole or a slit less than two or three
/// spacings wide may be closed where scans overlap. Where a seam meets the outline, up to the width
/// of an edge may be missing there. Where many seams meet about a closed shape, small holes may be
/// left: see `fill_holes`.
/// \throws InvalidInput if there is no scan, a scan is not valid (see `check_mesh`) or not manifold
/// (see `repair_mesh`) or its pose is not a rotation and a finite shift, all edges have no length,
/// or unless reach > 0 and finite.
[[nodiscard]] ZipperedScans zipper_scans(std::span<const Scan> scans,
                                         const ZipperScansOptions& options = {});

}  // namespace palpate::geometry
