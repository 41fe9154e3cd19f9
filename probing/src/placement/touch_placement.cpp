// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/touch_placement.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/registration.h"
#include "palpate/geometry/robust_weights.h"
#include "placement/pose_equations.h"
#include "placement/touch_doubts.h"

namespace palpate::probing {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;

/// A touch is off the surface if its distance is more than this many standard deviations, which few
/// touches give within a quarter only.
constexpr double kTouchOutlier = 5;

/// The number of used touches and their scatter are settled after a few rounds.
constexpr int kTouchRounds = 5;
constexpr int kMostTouchSteps = 20;

constexpr int kPoseUnknowns = 6;

/// A sliding motion is held only where the surface is inclined by 18 degrees against it (sine):
/// less may be noise.
constexpr double kRelief = 0.3;

/// At most about this many places of the surface are considered for a further touch.
constexpr Eigen::Index kPlacesToTouch = 400;

struct RefinedPose {
  Eigen::Isometry3d T_camera_base;
  geometry::TargetPlanes planes;
  std::vector<Eigen::Index> used;
  double variance = 0;  ///< [mm^2]

  [[nodiscard]] Eigen::Index usable() const { return planes.usable.count(); }
};

/// Standard deviation of the distances if half of the usable touches are on the surface.
double deviation_of(const geometry::TargetPlanes& planes) {
  std::vector<double> distances;
  for (Eigen::Index i = 0; i < planes.heights.size(); ++i)
    if (planes.usable[i]) distances.push_back(std::abs(planes.heights[i]));
  const auto count = static_cast<double>(distances.size());
  if (count <= kPoseUnknowns) return std::numeric_limits<double>::infinity();
  // The fit follows few touches, which makes their distances smaller than their errors.
  return geometry::deviation_of_median(median(distances)) *
         std::sqrt(count / (count - kPoseUnknowns));
}

std::vector<Eigen::Index> within_deviations(const geometry::TargetPlanes& planes,
                                            double deviation) {
  std::vector<Eigen::Index> used;
  for (Eigen::Index i = 0; i < planes.heights.size(); ++i)
    if (planes.usable[i] && std::abs(planes.heights[i]) <= kTouchOutlier * deviation)
      used.push_back(i);
  return used;
}

PoseEquations equations_of(const Matrix3Xd& places, const geometry::TargetPlanes& planes,
                           const std::vector<Eigen::Index>& used) {
  PoseEquations equations(places(Eigen::all, used));
  for (const Eigen::Index i : used) {
    const Vector3d normal = planes.normals.col(i);
    equations.add(places.col(i), normal * normal.transpose(), planes.heights[i] * normal);
  }
  return equations;
}

/// Least squares of the touches that agree, from the pose of the registration.
RefinedPose refine_touches(const Matrix3Xd& tips, const geometry::RegistrationTarget& target,
                           const Eigen::Isometry3d& start) {
  constexpr double kSmallStep = 1e-9;  // of the radius of the touches
  RefinedPose pose{.T_camera_base = start, .planes = planes_at(target, start * tips), .used = {}};
  for (int round = 0; round < kTouchRounds; ++round) {
    std::vector<Eigen::Index> used = within_deviations(pose.planes, deviation_of(pose.planes));
    if (used == pose.used) break;
    pose.used = std::move(used);
    for (int step = 0; step < kMostTouchSteps; ++step) {
      const Matrix3Xd places = pose.T_camera_base * tips;
      const PoseEquations equations = equations_of(places, pose.planes, pose.used);
      const Vector6d x = equations.solution();
      pose.T_camera_base = equations.to_motion(x) * pose.T_camera_base;
      pose.planes = planes_at(target, pose.T_camera_base * tips);
      if (x.norm() < kSmallStep * equations.radius) break;
    }
  }
  double squares = 0;
  for (const Eigen::Index i : pose.used) squares += pose.planes.heights[i] * pose.planes.heights[i];
  pose.variance = squares / std::max(1.0, static_cast<double>(pose.used.size()) - kPoseUnknowns);
  return pose;
}

std::vector<Candidate> further_touches(const geometry::TriangleMesh& surface,
                                       const geometry::RegistrationTarget& target, double radius) {
  const Matrix3Xd normals = vertex_normals(surface);
  std::vector<Eigen::Index> some;
  const Eigen::Index step = std::max<Eigen::Index>(1, surface.vertices.cols() / kPlacesToTouch);
  for (Eigen::Index i = 0; i < surface.vertices.cols(); i += step)
    if (normals.col(i).allFinite()) some.push_back(i);
  const Matrix3Xd places = surface.vertices(Eigen::all, some) + radius * normals(Eigen::all, some);
  const geometry::TargetPlanes planes = planes_at(target, places);
  // A tip that touches beside the vertex does not reach the vertex.
  const double kReached = 0.1 * radius;
  std::vector<Candidate> candidates;
  for (Eigen::Index i = 0; i < places.cols(); ++i) {
    if (!planes.usable[i] || std::abs(planes.heights[i]) > kReached) continue;
    const Vector3d normal = planes.normals.col(i);
    candidates.push_back({places.col(i), normal * normal.transpose()});
  }
  return candidates;
}

/// The radius follows from the touches as far as no motion changes all distances alike.
void doubt_radius(const Matrix3Xd& places, const RefinedPose& pose, const PoseEquations& equations,
                  double radius, ArmPlacement& placement) {
  constexpr double kDeviations = 4;
  constexpr double kMuch = 0.1;  // [mm] that a doubt is worth
  Vector6d alike = Vector6d::Zero();
  double heights = 0;
  for (const Eigen::Index i : pose.used) {
    alike += equations.motion_at(places.col(i)).transpose() * pose.planes.normals.col(i);
    heights += pose.planes.heights[i];
  }
  const double fixed =
      static_cast<double>(pose.used.size()) - alike.dot(equations.normal.ldlt().solve(alike));
  if (!(fixed > 0)) return;
  const double more = heights / fixed, deviation = std::sqrt(pose.variance / fixed);
  if (std::abs(more) < std::max(kMuch, kDeviations * deviation)) return;
  placement.doubts.push_back(
      fmt::format("the touches fit a tip with a radius of {:.2f} +- {:.2f} mm better than one of "
                  "{:.2f} mm",
                  radius + more, deviation, radius));
}

/// Motions along which the touches slide, for these equations.
void release_slides(const geometry::Registration& found, PoseEquations& equations) {
  for (const geometry::FreeMotion& motion : found.free_motions) {
    Vector6d x;
    x << motion.rotation * equations.radius,
        motion.translation + motion.rotation.cross(equations.centre - found.centre);
    equations.release(x);
  }
}

void check_tips(const Eigen::Ref<const Matrix3Xd>& tips) {
  for (Eigen::Index i = 0; i < tips.cols(); ++i) {
    if (!tips.col(i).allFinite()) {
      throw InvalidInput(
          fmt::format("place_by_touches: touch {} has a coordinate that is not finite", i + 1));
    }
  }
}

}  // namespace

void visit(TouchPlacementOptions& options, FieldVisitor& visitor) {
  visitor.begin("TouchPlacementOptions");
  visitor.real(
      {"tip_radius",
       "Radius of the tip if the positions are those of its centre; 0 if they are those of "
       "the touched points",
       "mm"},
      options.tip_radius, at_least(0).finite());
  visitor.real({"start_turn", "How far the start pose may be turned from the true one", "rad"},
               options.start_turn, at_least(0).at_most(std::numbers::pi));
  visitor.real({"start_shift",
                "How far the start pose may be shifted from the true one, at the touches", "mm"},
               options.start_shift, at_least(0).finite());
}

ArmPlacement place_by_touches(const Eigen::Ref<const Matrix3Xd>& tips,
                              const geometry::TriangleMesh& surface,
                              const TouchPlacementOptions& options) {
  static_cast<void>(in_range(options));
  check_tips(tips);
  const geometry::RegistrationTarget target(surface, options.tip_radius);
  ArmPlacement placement;
  placement.residuals.assign(static_cast<std::size_t>(tips.cols()),
                             {.distance = std::numeric_limits<double>::quiet_NaN()});
  if (const auto impossible = impossible_touches(tips, surface)) {
    placement.reason = *impossible;
    return placement;
  }
  const geometry::Registration found = search_touches(tips, surface, target, options);
  const RefinedPose pose = refine_touches(tips, target, found.T_target_source);
  placement.T_camera_base = pose.T_camera_base;
  placement.used = static_cast<int>(pose.used.size());
  for (Eigen::Index i = 0; i < tips.cols(); ++i) {
    placement.residuals[static_cast<std::size_t>(i)] = {.distance = pose.planes.heights[i],
                                                        .at_border = !pose.planes.usable[i]};
  }
  double squares = 0;
  for (const Eigen::Index i : pose.used) {
    placement.residuals[static_cast<std::size_t>(i)].used = true;
    squares += pose.planes.heights[i] * pose.planes.heights[i];
  }
  placement.rms = placement.used > 0 ? std::sqrt(squares / placement.used)
                                     : std::numeric_limits<double>::quiet_NaN();
  const Matrix3Xd places = placement.T_camera_base * tips;
  PoseEquations equations = equations_of(places, pose.planes, pose.used);
  release_slides(found, equations);
  const std::optional<std::string> free =
      state_errors(equations, pose.variance, further_touches(surface, target, options.tip_radius),
                   found.free_motions.empty() ? 0 : kRelief, placement);

  using enum geometry::RegistrationVerdict;
  const bool fits = found.verdict == accepted;
  const bool enough = placement.used >= kFewestTouches && 2 * placement.used > pose.usable();
  placement.determined = fits && !free && enough;
  placement.reason = found.reason;
  if (fits && free) placement.reason = "the touches do not determine " + *free;
  if (fits && !free) {
    placement.reason = fmt::format(
        "{} of {} touches agree within {:.3g} mm (RMS), {} are at the border of the surface",
        placement.used, tips.cols(), placement.rms, tips.cols() - pose.usable());
  }
  if (fits && !free && !enough)
    placement.reason +=
        fmt::format("; at least {}, and more than half, must agree", kFewestTouches);
  if (found.verdict == slides && !placement.advice)
    placement.reason +=
        "; no other touch of this surface would help: use an object whose normals differ more";
  explain_misfit(tips, surface, target, options, found, placement);
  if (placement.determined) {
    doubt_frame(placement);
    doubt_radius(places, pose, equations, options.tip_radius, placement);
  }
  return placement;
}

}  // namespace palpate::probing
