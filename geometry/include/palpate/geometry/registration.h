// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <limits>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// How the pose that the search found is settled with all points.
enum class RegistrationMethod {
  /// To the nearest point of the triangles themselves, in double; each step moves the points to the
  /// planes there (Chen and Medioni 1992), those that do not belong weighted down (Tukey).
  point_to_triangle,
  /// To the plane at the nearest vertex: PCL's IterativeClosestPointWithNormals, in single
  /// precision; no better than the mesh is fine.
  point_to_plane,
  /// To the nearest vertex: PCL's IterativeClosestPoint, in single precision; as above.
  point_to_point
};

struct RegistrationOptions {
  RegistrationMethod method = RegistrationMethod::point_to_triangle;
  /// Where the search begins.
  Eigen::Isometry3d T_target_source_start = Eigen::Isometry3d::Identity();
  /// [rad] how far about the points' centroid the start may be turned from the truth; in [0, pi].
  /// Poses that turn further are not looked for, nor missed by the verdict.
  double search_rotation = std::numbers::pi / 4;
  /// [mm] how far from its true place the start may have put the points' centroid; >= 0. Infinity:
  /// unknown, but the points are spread over the target, or begin within 10 % of its diagonal.
  /// Points of a part of it that begin further away need a finite bound, and time that grows with
  /// its cube. With this and `search_rotation` = 0 there is no search.
  double search_translation = std::numeric_limits<double>::infinity();
  /// Fraction of the points that lie on the target if they belong to it; in (0, 1]. Fewer are not
  /// accepted; at least half of these must fit for the pose to be found.
  double min_overlap = 0.5;
  /// [mm] a larger `rms` is not accepted; > 0.
  double max_rms = std::numeric_limits<double>::infinity();
  int max_iterations = 100;  ///< of the last stage; >= 1
};

enum class RegistrationVerdict {
  accepted,
  /// The steps had not settled after `max_iterations`, or lost the surface.
  not_converged,
  /// Fewer than ten points more on the surface than the pose has degrees of freedom that the
  /// surface fixes: so few fit anywhere.
  too_few_points,
  little_overlap,  ///< less than `min_overlap`
  slides,          ///< on a plate, a sphere, a cylinder: see `free_motions`
  ambiguous,       ///< another pose fits nearly as well: see `runner_up`
  poor_fit         ///< `rms` above `max_rms`, or not much better than at poses nearby
};

/// A motion that the distances to the surface do not fix.
struct FreeMotion {
  /// Turn about `Registration::centre` [rad] and shift [mm], in the target's axes; scaled so that
  /// the points move by the length that was tried.
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  std::string description;  ///< "a shift along (1, 0, 0)", "a turn about ..."
};

struct Registration {
  /// Maps source points to the target's frame.
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
  /// Read this before you use the pose.
  RegistrationVerdict verdict = RegistrationVerdict::not_converged;
  std::string reason;  ///< the verdict in a sentence, with its figures
  /// [mm] root mean square distance from the surface of the `inliers`; NaN if there are none.
  double rms = 0;
  double median = 0;   ///< [mm] median distance from the surface of all finite points
  int inliers = 0;     ///< points whose distance fits the others'
  double overlap = 0;  ///< `inliers` as a fraction of the finite points
  /// [mm] median distance at the best pose found that differs; NaN if all starts led to one.
  double runner_up = 0;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [mm] centroid of the moved points
  /// Covariance of the pose: s^2 (sum of j j^T)^-1, where j is the change of a point's distance to
  /// its plane and s^2 the inliers' mean square distance (over count minus 6). Order: turn about
  /// `centre` [rad] about the target's x, y, z, then shift [mm] along them. A motion that is not
  /// fixed counts with a standard deviation of the target's diagonal.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<FreeMotion> free_motions;  ///< empty unless the points slide
  int starts = 0;                        ///< poses from which the search began
  int iterations = 0;                    ///< of the last stage
};

/// A mesh prepared for registrations onto it: search trees and a coarse map of where it is nearest.
/// Copies share what is prepared; const use is thread-safe.
class RegistrationTarget {
 public:
  /// \throws InvalidInput on a bad mesh, or one without a triangle that has an area.
  explicit RegistrationTarget(const TriangleMesh& mesh);

  struct Impl;
  [[nodiscard]] const Impl& impl() const { return *impl_; }  ///< for the library itself

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Moves points rigidly onto a mesh: searches from several poses on a coarse map of the surface,
/// settles the best by iterated closest points (Besl and McKay 1992), and judges the result. The
/// same input gives the same result whatever the number of threads.
///
/// The starts are `T_target_source_start`, the same shifted so that the points' centroid meets the
/// surface's (no further than `search_translation`), and, if `search_translation` is finite,
/// shifted by a cubic lattice of a tenth of the target's diagonal within it (and within half the
/// diagonal); each turned about the centroid by the rotation vectors of a cubic lattice of at most
/// 25 degrees within `search_rotation`.
///
/// `points` is 3 x N [mm]; points that are not finite are left out.
/// \throws InvalidInput on fewer than three finite points, or an option out of range.
[[nodiscard]] Registration register_points(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                           const RegistrationTarget& target,
                                           const RegistrationOptions& options = {});

/// The same for a single use.
/// \throws InvalidInput as above, or on a bad mesh.
[[nodiscard]] Registration register_points(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                           const TriangleMesh& target,
                                           const RegistrationOptions& options = {});

/// The verdict's name as in the enumeration.
[[nodiscard]] const char* to_string(RegistrationVerdict verdict);

}  // namespace palpate::geometry
