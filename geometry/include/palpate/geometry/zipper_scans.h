// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>
#include <vector>

#include "palpate/geometry/merge_scans.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct ZipperScansOptions {
  /// Two scans see the same place if they are within this many point spacings of each other there
  /// and face the same half-space; > 0, finite. Should be larger than the steps that noise and
  /// registration leave between scans, and smaller than the thickness of the object.
  double reach = 2;
};

/// A measured point.
struct ScanVertex {
  int scan = -1;
  int vertex = -1;
};

struct ZipperedScans {
  TriangleMesh mesh;               ///< in the frame of the object
  std::vector<ScanVertex> source;  ///< source of each vertex, to copy attributes
  double spacing = 0;              ///< [mm] median edge length of the scans
  int dropped = 0;                 ///< scan triangles removed because another scan covers them
  int seam = 0;                    ///< triangles between vertices of different scans
};

/// Joins overlapping registered scans into one surface with border, after Turk and Levoy 1994.
///
/// Where two scans see the same place, the one whose own border is farther away is kept (a
/// silhouette, where a camera measures badly, is thus dropped); a later scan must be farther by
/// more than a few spacings. The gap between the pieces, one or two edges wide, is closed with
/// triangles between their vertices. Unlike in the paper, no triangle is clipped and no vertex
/// moved: every vertex is a measured one, and away from the seams the triangles are those of the
/// scans. Nothing is averaged, so a step between scans remains as a steep seam; use `merge_scans`
/// to average.
///
/// Scans are added in their order, each to the surface of the earlier ones. The surface is oriented
/// and manifold. Limits: scans should have similar density; holes and slits less than two or three
/// spacings wide may be closed where scans overlap; where a seam meets the outline, up to an edge's
/// width may be missing; where many seams meet around a closed shape, small holes may remain (see
/// `fill_holes`).
/// \throws InvalidInput if there is no scan, a scan is not valid (see `check_mesh`) or not manifold
/// (see `repair_mesh`) or its pose is not rigid and finite, all edges have zero length, or unless
/// reach > 0 and finite.
[[nodiscard]] ZipperedScans zipper_scans(std::span<const Scan> scans,
                                         const ZipperScansOptions& options = {});

}  // namespace palpate::geometry
