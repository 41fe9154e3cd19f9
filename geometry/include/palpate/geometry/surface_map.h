// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Pairs of points that belong to each other, 3 x L each [mm].
struct Landmarks {
  Eigen::Matrix3Xd source;
  Eigen::Matrix3Xd target;
};

struct SurfaceMapOptions {
  /// A landmark further from its surface than this fraction of the surface's diagonal is refused;
  /// > 0. (It is then put on the surface.)
  double max_landmark_distance = 0.02;
  /// An area is distorted iff its image is stretched by more than this factor more, or less, than
  /// the whole surface is, in area; > 1.
  double max_area_distortion = 3;
  /// An area is distorted iff it is stretched by more than this factor more in one direction than
  /// across; > 1.
  double max_angle_distortion = 3;
  /// The map is not sensible iff a larger share of the area than this is distorted or folded; in
  /// [0, 1].
  double max_bad_share = 0.2;
};

enum class SurfaceMapVerdict {
  sensible,
  distorted,  ///< some of the area is distorted or folded, at most `max_bad_share`
  not_sensible
};

/// Where the points of one surface are on another.
struct SurfaceMap {
  /// Read this before you use the map.
  SurfaceMapVerdict verdict = SurfaceMapVerdict::not_sensible;
  std::string reason;          ///< the verdict in a sentence, with its figures
  Eigen::Matrix3Xd positions;  ///< [mm] 3 x V, on the target, of the source's vertices
  /// Of the map of each source triangle, 2 x T, the larger first; NaN for one without area.
  Eigen::Matrix2Xd singular_values;
  Eigen::VectorXd area_distortion;               ///< T, their product over the mean of all; 1: none
  Eigen::VectorXd angle_distortion;              ///< T, their ratio; 1: none
  Eigen::Array<bool, Eigen::Dynamic, 1> folded;  ///< T: the image shows its back
  Eigen::Array<bool, Eigen::Dynamic, 1> distorted;  ///< T: beyond the bounds, or folded
  double scale = 1;            ///< square root of the ratio of areas, image over source
  double distorted_share = 0;  ///< of the source's area, folded or not
  double folded_share = 0;     ///< of the source's area
  double coverage = 0;         ///< area of the image, of what is not folded, over the target's
  double landmark_rms = 0;     ///< [mm] from the images of the source's landmarks to the target's
};

/// Maps a surface onto another of the same topology, guided by a few landmarks.
///
/// The landmarks give a similarity (Umeyama 1991) and, by what is left of them, an affine map and a
/// thin-plate spline, which bring the source near the target. From there it is drawn onto the
/// target, as rigidly as possible (Sorkine and Alexa 2007) and less and less stiff, its border onto
/// the target's, landmarks onto theirs:
///
///     sum_v a_v |x_v - q_v|^2 + mean_k |x(s_k) - t_k|^2
///       + l^2 sum_e w_e (|x_i - x_j - R_i (y_i - y_j)|^2 + |x_i - x_j - R_j (y_i - y_j)|^2) / 2
///
/// with y the splined source, q the nearest points of the target that face the same way, a the
/// vertices' shares of the area, ten times that for those of the border, w cotangent weights (those
/// below zero left out) over twice the area, l from a quarter to a hundredth of the diagonal. In
/// the end each vertex is put on the nearest point. Between landmarks the map is a guess that
/// distorts little; it is exact for a rigid motion and a uniform scale, and for an affine map if
/// the landmarks are not in a plane.
/// \throws InvalidInput on a bad mesh or option, meshes that are not manifold, not of one component
/// each, or differ in the number of border loops or holes through them (Euler characteristic),
/// fewer than three landmarks, as many on both sides, that are finite, near their surface, and not
/// nearly in a line on either; SolverError if the equations cannot be solved.
[[nodiscard]] SurfaceMap map_surface(const TriangleMesh& source, const TriangleMesh& target,
                                     const Landmarks& landmarks,
                                     const SurfaceMapOptions& options = {});

/// How the map turns the surface at each of the source's vertices, V rotations: the nearest to its
/// mean gradient there, normal onto normal.
[[nodiscard]] std::vector<Eigen::Matrix3d> local_rotations(const TriangleMesh& source,
                                                           const SurfaceMap& map);

/// Means at the vertices, V, of values of the triangles, weighted by their areas; NaN where there
/// is none that is finite. \throws InvalidInput unless there is one value a triangle.
[[nodiscard]] Eigen::VectorXd vertex_means(const TriangleMesh& mesh,
                                           const Eigen::Ref<const Eigen::VectorXd>& values);

/// "sensible", ...
[[nodiscard]] const char* to_string(SurfaceMapVerdict verdict);

}  // namespace palpate::geometry
