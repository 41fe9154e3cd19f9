// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// Method that refines the pose found by the search, with all points.
enum class RegistrationMethod {
  /// Uses the nearest points of the triangles, in double precision. Each step moves the points to
  /// the tangent planes there (Chen and Medioni 1992); outliers are weighted down (Tukey).
  point_to_triangle,
  /// Uses the plane at the nearest vertex: PCL's IterativeClosestPointWithNormals, in single
  /// precision. The accuracy is limited by the resolution of the mesh.
  point_to_plane,
  /// Uses the nearest vertex: PCL's IterativeClosestPoint, in single precision; as above.
  point_to_point
};

/// `visit` describes the fields.
struct RegistrationOptions {
  RegistrationMethod method = RegistrationMethod::point_to_triangle;
  /// Start pose of the search.
  Eigen::Isometry3d T_target_source_start = Eigen::Isometry3d::Identity();
  /// Poses beyond it are not searched, and the verdict does not consider them, unless the pose
  /// found is itself beyond it: then the verdict considers all poses as far from the start as that.
  double search_rotation = std::numbers::pi / 4;
  /// Infinity means unknown, which works if the points cover the target or start within 10 % of its
  /// diagonal. Points of a part of the target that start farther away need a finite value; the time
  /// grows with its cube. If this and `search_rotation` are 0, there is no search.
  double search_translation = std::numeric_limits<double>::infinity();
  /// At least half of these must fit for the pose to be found.
  double min_overlap = 0.5;
  double max_rms = std::numeric_limits<double>::infinity();
  int max_iterations = 100;
  /// Called in the calling thread after each part of the work, each iteration and some thousands of
  /// points; the last call has done == total. If it throws, the registration ends.
  std::function<void(int done, int total)> progress = {};
};

void visit(RegistrationOptions& options, FieldVisitor& visitor);

enum class RegistrationVerdict {
  accepted,
  /// The refinement did not converge within `max_iterations`, or lost the surface.
  not_converged,
  /// The number of points on the surface exceeds the degrees of freedom that the surface fixes by
  /// fewer than ten; so few points fit anywhere.
  too_few_points,
  little_overlap,  ///< less than `min_overlap`
  slides,          ///< on a plate, a sphere, a cylinder: see `free_motions`
  ambiguous,       ///< another pose fits nearly as well: see `runner_up`
  poor_fit         ///< `rms` above `max_rms`, or not much better than at poses nearby
};

/// A motion that hardly changes the distances to the surface.
struct FreeMotion {
  /// Rotation about `Registration::centre` [rad] and translation [mm], in the target's axes; scaled
  /// so that the points move by the tested length.
  Eigen::Vector3d rotation = Eigen::Vector3d::Zero();
  Eigen::Vector3d translation = Eigen::Vector3d::Zero();
  std::string description;  ///< "a shift along (1, 0, 0)", "a turn about ..."
};

struct Registration {
  /// Maps source points to the target's frame.
  Eigen::Isometry3d T_target_source = Eigen::Isometry3d::Identity();
  /// Check this before you use the pose.
  RegistrationVerdict verdict = RegistrationVerdict::not_converged;
  std::string reason;  ///< the verdict in a sentence, with figures
  /// [mm] root mean square distance of the `inliers` from the surface; NaN if there are none.
  double rms = 0;
  /// [mm] median distance of the finite points from the surface; if `min_overlap` is below 0.5, of
  /// the nearest 2 `min_overlap` of them, because the others need not lie on the surface.
  double median = 0;
  int inliers = 0;     ///< points whose distance is consistent with the others'
  double overlap = 0;  ///< `inliers` as a fraction of the finite points
  /// [mm] the same at the best different pose; empty if all starts led to the same pose.
  std::optional<double> runner_up;
  Eigen::Vector3d centre = Eigen::Vector3d::Zero();  ///< [mm] centroid of the moved points
  /// Covariance of the pose: s^2 (sum of j j^T)^-1, where j is the derivative of a point's distance
  /// to its plane and s^2 the inliers' mean square distance (over count minus 6). Order: rotation
  /// about `centre` [rad] about the target's x, y, z, then translation [mm] along them. A free
  /// motion gets the target's diagonal as its standard deviation.
  Eigen::Matrix<double, 6, 6> covariance = Eigen::Matrix<double, 6, 6>::Zero();
  std::vector<FreeMotion> free_motions;  ///< empty unless the points slide
  int starts = 0;                        ///< number of start poses of the search
  int iterations = 0;                    ///< of the refinement
};

/// A mesh prepared for registration: search trees and a coarse map of the nearest surface. Copies
/// share this data; const use is thread-safe. With a standoff, `Registration` states distances from
/// the places at this distance from the surface.
class RegistrationTarget {
 public:
  /// \param standoff [mm] >= 0: the points belong this far from the surface, on the side to which
  /// its normals point. Centres of balls that touch it have the radius of the balls.
  /// \throws InvalidInput if the mesh is not valid, no triangle has an area, or `standoff` is
  /// outside its range.
  explicit RegistrationTarget(const TriangleMesh& mesh, double standoff = 0);

  struct Impl;
  [[nodiscard]] const Impl& impl() const { return *impl_; }  ///< for the library itself

 private:
  std::shared_ptr<const Impl> impl_;
};

/// Registers points rigidly to a mesh: searches from several poses on a coarse map of the surface,
/// refines the best by iterated closest points (Besl and McKay 1992), and assesses the result. The
/// result is deterministic and independent of the number of threads.
///
/// Start poses: `T_target_source_start`; the same translated so that the points' centroid meets the
/// surface's (by at most `search_translation`); and, if `search_translation` is finite, translated
/// by a cubic lattice with a spacing of a tenth of the target's diagonal within it (and within half
/// the diagonal). Each is also rotated about the centroid by the rotation vectors of a cubic
/// lattice with a spacing of at most 25 degrees within `search_rotation`.
/// \param points 3 x N [mm]; points that are not finite are ignored.
/// \throws InvalidInput if fewer than three points are finite, or an option is outside its range.
[[nodiscard]] Registration register_points(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                           const RegistrationTarget& target,
                                           const RegistrationOptions& options = {});

/// The same for a single use.
/// \throws InvalidInput as above, or if the mesh is not valid.
[[nodiscard]] Registration register_points(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                           const TriangleMesh& target,
                                           const RegistrationOptions& options = {});

/// The planes of a target at the nearest places to points, one column per point.
struct TargetPlanes {
  Eigen::Matrix3Xd normals;  ///< unit
  Eigen::VectorXd heights;   ///< [mm] of the points above the planes, signed
  /// False if the point lies beside the surface, or has no nearest place.
  Eigen::Array<bool, Eigen::Dynamic, 1> usable;
};

/// The planes to which `register_points` moves points.
/// \param points 3 x N [mm], in the frame of the target.
[[nodiscard]] TargetPlanes planes_at(const RegistrationTarget& target,
                                     const Eigen::Ref<const Eigen::Matrix3Xd>& points);

/// A small motion in words: "a shift along (1.00, 0.00, 0.00)", "a turn about ...".
/// \param radius [mm] typical distance of the points from the centre of the rotation [rad].
[[nodiscard]] std::string describe_motion(const Eigen::Vector3d& rotation,
                                          const Eigen::Vector3d& translation, double radius);

/// Name of a verdict as in the enumeration.
[[nodiscard]] const char* to_string(RegistrationVerdict verdict);

}  // namespace palpate::geometry
