// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A view of an object.
struct Scan {
  TriangleMesh mesh;  ///< triangles face the outside of the object
  Eigen::Isometry3d T_object_scan = Eigen::Isometry3d::Identity();  ///< scan to object
  /// [mm] standard deviations of the vertices, > 0 and finite; empty if they are not known. Only
  /// `merge_scans` uses them.
  Eigen::VectorXd sigma = {};
  /// [mm] in the frame of the scan: from here, the whole mesh was seen at one time. Only
  /// `merge_scans` uses it, to find scans that do not belong together.
  std::optional<Eigen::Vector3d> viewpoint = {};
  std::string name = {};  ///< for messages, such as its file; empty: its number is its name
};

/// `visit` describes the fields.
struct MergeScansOptions {
  std::optional<double> spacing = {};
  double reach = 3;
  double max_memory = 4;
  /// Called in the calling thread before and after each scan is added, with the number of scans
  /// done and of all; up to four are computed at a time. If it throws, the merging ends.
  std::function<void(int done, int total)> progress = {};
};

void visit(MergeScansOptions& options, FieldVisitor& visitor);

/// Two scans that cannot both be right: one saw through a place where the other has a surface.
struct ScanConflict {
  int scan = 0;      ///< saw places ...
  int other = 0;     ///< ... that this one hides
  double share = 0;  ///< hidden places of all that are near to, or behind, the other's surface
  double depth = 0;  ///< [mm] median distance of the hidden places behind it
};

struct MergedScans {
  TriangleMesh mesh;  ///< in the frame of the object
  /// [mm] standard deviations of the vertices; empty unless all scans have a `sigma`
  Eigen::VectorXd sigma;
  double spacing = 0;  ///< [mm] of the grid
  /// Check this before you use the mesh: pairs of scans that disagree in more than a tenth of their
  /// common part, worst first. The object moved, or poses are wrong, by more than `reach`.
  std::vector<ScanConflict> conflicts;
};

/// Merges registered, overlapping scans into one surface that averages them.
///
/// For each scan, the signed distance to it is computed at the points of a cubic grid near it.
/// Where there are distances to several scans, their mean is taken, weighted by 1 / sigma^2 and
/// less at the border of a scan (Curless and Levoy 1996). The surface is where the mean is zero. It
/// is oriented and manifold, open where no scan measured, and ends within one spacing of the border
/// of the scans. It may consist of several parts. Small parts near a larger one are left out,
/// because noise makes them at the edge of the reach. Walls should be thicker than two spacings.
/// The standard deviations of the result are those of means of independent scans; they do not
/// contain errors that scans have in common, such as those of calibration and registration. Use
/// `zipper_scans` to keep the measured vertices.
///
/// Scans are compared along the lines on which their places were seen: to the viewpoint, or, if it
/// is not known, a short way along the normals. No surface of another scan may be there.
///
/// The order of the scans matters only for rounding.
/// \throws InvalidInput if there is no scan, a scan is not valid (see `check_mesh`), not manifold
/// or not oriented (see `repair_mesh`), its pose is not rigid and finite, its viewpoint is not
/// finite, its standard deviations are not one for each vertex, all edges have zero length, an
/// option is outside its range, or the grid has too many points or needs more memory than allowed
/// (the message names a spacing that fits).
/// \throws SolverError if no cell of the grid has a surface: the spacing is too large.
[[nodiscard]] MergedScans merge_scans(std::span<const Scan> scans,
                                      const MergeScansOptions& options = {});

}  // namespace palpate::geometry
