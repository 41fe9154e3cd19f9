// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Pairs of corresponding points, 3 x L each [mm].
struct Landmarks {
  Eigen::Matrix3Xd source;
  Eigen::Matrix3Xd target;
};

/// The meaning, unit and range of each field stand in its list, `visit`.
struct SurfaceMapOptions {
  double max_bad_share = 0.2;
  double max_area_distortion = 3;
  double max_angle_distortion = 3;
  double max_landmark_distance = 0.02;  ///< nearer landmarks are projected onto the surface
};

void visit(SurfaceMapOptions& options, FieldVisitor& visitor);

enum class SurfaceMapVerdict {
  sensible,
  distorted,  ///< some of the area, at most `max_bad_share`, is distorted or folded
  not_sensible
};

/// Map from one surface onto another.
struct SurfaceMap {
  /// Check this before you use the map.
  SurfaceMapVerdict verdict = SurfaceMapVerdict::not_sensible;
  std::string reason;          ///< the verdict in a sentence, with figures
  Eigen::Matrix3Xd positions;  ///< [mm] 3 x V, images of the source's vertices on the target
  /// 2 x T: singular values of the map of each source triangle, the larger first; NaN for a
  /// triangle without area.
  Eigen::Matrix2Xd singular_values;
  Eigen::VectorXd area_distortion;   ///< T, product of both over the mean product; 1 if undistorted
  Eigen::VectorXd angle_distortion;  ///< T, ratio of both; 1 if undistorted
  Eigen::Array<bool, Eigen::Dynamic, 1> folded;     ///< T: the image of the triangle is flipped
  Eigen::Array<bool, Eigen::Dynamic, 1> distorted;  ///< T: beyond the limits, or folded
  double scale = 1;            ///< square root of the ratio of areas, image over source
  double distorted_share = 0;  ///< of the source's area, folded or not
  double folded_share = 0;     ///< of the source's area
  double coverage = 0;         ///< area of the unfolded part of the image over the target's area
  double landmark_rms = 0;     ///< [mm] between images of source landmarks and target landmarks
};

/// Maps a surface onto another of the same topology, guided by a few landmarks.
///
/// First a similarity (Umeyama 1991), then an affine map and a thin-plate spline fitted to the
/// remaining landmark errors bring the source close to the target. Then the source is deformed as
/// rigidly as possible (Sorkine and Alexa 2007), with decreasing stiffness l, towards the target,
/// its border towards the target's border, and landmarks towards landmarks, minimising
///
///     sum_v a_v |x_v - q_v|^2 + mean_k |x(s_k) - t_k|^2
///       + l^2 sum_e w_e (|x_i - x_j - R_i (y_i - y_j)|^2 + |x_i - x_j - R_j (y_i - y_j)|^2) / 2
///
/// where y is the source after the spline, q the nearest points of the target with a normal in the
/// same half-space, a the vertices' shares of the area (ten times that at the border), w cotangent
/// weights (negative ones omitted) over twice the area, and l goes from a quarter to a hundredth of
/// the diagonal. Finally each vertex is projected onto the target. Between landmarks the map is a
/// guess of low distortion. It is exact for a rigid motion with uniform scale, and for an affine
/// map if the landmarks are not coplanar.
/// \throws InvalidInput if a mesh or option is not valid; if a mesh is not manifold or has several
/// components; if the meshes differ in border loops or Euler characteristic; or unless both sides
/// have the same number, at least three, of landmarks that are finite, near their surface and not
/// nearly collinear.
/// \throws SolverError if the equations cannot be solved.
[[nodiscard]] SurfaceMap map_surface(const TriangleMesh& source, const TriangleMesh& target,
                                     const Landmarks& landmarks,
                                     const SurfaceMapOptions& options = {});

/// Rotation of the surface by the map at each of the source's vertices, V rotations: the one
/// nearest to the mean gradient there that maps normal to normal.
[[nodiscard]] std::vector<Eigen::Matrix3d> local_rotations(const TriangleMesh& source,
                                                           const SurfaceMap& map);

/// Area-weighted means at the vertices, V, of values of the triangles; NaN where no value is
/// finite.
/// \throws InvalidInput unless there is one value per triangle.
[[nodiscard]] Eigen::VectorXd vertex_means(const TriangleMesh& mesh,
                                           const Eigen::Ref<const Eigen::VectorXd>& values);

/// Name of a verdict: "sensible", ...
[[nodiscard]] const char* to_string(SurfaceMapVerdict verdict);

}  // namespace palpate::geometry
