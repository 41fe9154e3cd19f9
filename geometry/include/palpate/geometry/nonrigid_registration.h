// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <span>
#include <vector>

#include "palpate/geometry/deformation_graph.h"
#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

struct NonRigidOptions {
  int max_iterations = 60;  ///< >= 1
  /// A vertex is drawn to the measured surface iff it is within this fraction of the mesh's
  /// diagonal of it: at the start, where it has to span the deformation; > 0.
  double max_correspondence = 0.06;
  /// The same at the end, where it has to keep out what does not belong to the surface: in (0,
  /// max_correspondence].
  double min_correspondence = 0.01;
  double max_normal_angle = 1.0;  ///< [rad] between the two surfaces; in (0, pi/2)
  /// How much a node resists being moved otherwise than its neighbours, against the measured points
  /// around it (1: as much): low follows small dents and noise, high bridges holes smoothly; > 0.
  double stiffness = 0.01;
  /// `stop` is `poor_match` iff the surface settled and less than this fraction of the vertices
  /// before which something was measured are on the measured surface; in [0, 1].
  double min_matched = 0.3;
};

/// How a vertex of the deformed surface stands to the range map.
enum class VertexSight : std::uint8_t {
  seen,         ///< on the measured surface
  occluded,     ///< behind something that was measured
  hole,         ///< its pixel has no depth, or not enough neighbours that have
  outside,      ///< not in the image
  turned_away,  ///< shows its back to the camera
  unmatched     ///< what its pixel shows is behind it, or turned otherwise
};

enum class NonRigidStop {
  converged,       ///< no node moved any more; what was seen fits
  max_iterations,  ///< not settled yet
  no_overlap,      ///< fewer than six of the vertices tried could be drawn to the map
  poor_match       ///< settled, but less than `min_matched` fits: another object, or a bad start
};

struct DeformedSurface {
  Eigen::Matrix3Xd vertices;                    ///< [mm] 3 x V, deformed, all finite; camera frame
  std::vector<Eigen::Isometry3d> node_motions;  ///< N, from the undeformed mesh
  std::vector<VertexSight> sight;               ///< V
  /// [mm] 3 x V, where the ray to a vertex meets the measured surface; NaN unless seen.
  Eigen::Matrix3Xd measured;
  std::vector<int> pixel;  ///< V, row * cols + col of a vertex that is seen, otherwise -1
  /// V, in [0, 1]: near 1 on the measured surface, 0 at the gate of `min_correspondence` or where
  /// the vertex is not seen and only follows its neighbours.
  Eigen::VectorXd confidence;
  double rms = 0;      ///< [mm] distance of the vertices that are seen from the plane of their
                       ///< measured point; NaN if none is
  double matched = 0;  ///< fraction seen of those before which something was measured
  int iterations = 0;
  /// Read this before you use the vertices.
  NonRigidStop stop = NonRigidStop::max_iterations;
};

/// Deforms a surface so that it lies on a range map (of the same camera frame), by embedded
/// deformation: Gauss-Newton steps on
///
///     sum_v  rho(n . (v' - p))  +  stiffness  sum_jk  | R_j (g_k - g_j) - (g'_k - g'_j) |^2
///
/// p and n are point and normal of the pixel that shows v' (projective association, with the lens),
/// rho is Tukey's biweight at the correspondence gate; g are nodes, R_j their rotations. Stiffness
/// and gate start high and fall, so that the surface first moves as a whole. Where nothing of it is
/// measured the surface follows its neighbours, as rigidly as possible; what nothing holds stays. A
/// point-to-point term is left out: along a pixel's ray it says what the plane says; it would only
/// slow sliding, which the damping of the steps does.
///
/// What slides along the surface shows only in its relief: on a plane or a sphere the motion along
/// the surface is that of the least distortion, not the true one.
///
/// `start`: node motions of a frame before; the surface then follows from there and is not stiff at
/// first. It follows by up to max_correspondence (min_correspondence / max_correspondence)^0.6, a
/// third of `max_correspondence` by default. Without `start` the search starts undeformed.
/// \throws InvalidInput on a bad camera or option, or a start of another graph; SolverError if the
/// equations of a step cannot be solved.
[[nodiscard]] DeformedSurface register_deformed(const DeformationGraph& graph, const RangeMap& map,
                                                const NonRigidOptions& options = {},
                                                std::span<const Eigen::Isometry3d> start = {});

/// The same for many frames that are each within reach of the undeformed surface: every one starts
/// there, in parallel, so that an error in one does not go on to the next. A motion that goes
/// further has to be tracked from frame to frame, by `start`.
/// \throws InvalidInput or SolverError as above, whichever frame it is: then there is no result of
/// the others either.
[[nodiscard]] std::vector<DeformedSurface> register_deformed_frames(
    const DeformationGraph& graph, std::span<const RangeMap> maps,
    const NonRigidOptions& options = {});

}  // namespace palpate::geometry
