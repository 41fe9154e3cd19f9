// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/registration.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "base/numbers.h"
#include "base/rigid_motion.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"
#include "palpate/core/work_steps.h"
#include "palpate/geometry/robust_weights.h"
#include "registration/pose_search.h"
#include "registration/pose_verdict.h"
#include "registration/registration_pcl.h"
#include "registration/registration_target.h"
#include "registration/spatial_order.h"

namespace palpate::geometry {
namespace {

constexpr int kMinPoints = 3;

constexpr std::array<std::string_view, 3> kMethods{"point_to_triangle", "point_to_plane",
                                                   "point_to_point"};

/// Steps of the work: the rounds of the search, its choice, the refinement with some points and
/// with all, and the verdict.
constexpr int kSteps = kSearchRounds + 4;

/// Numbers of points for the search, and for refining candidates.
constexpr Eigen::Index kSearchPoints = 200;
constexpr Eigen::Index kCandidatePoints = 300;
constexpr int kCandidateSteps = 12;

/// Number of points for the steps before those with all points; these steps are done only if there
/// are at least kLeastGain times as many points.
constexpr Eigen::Index kCoarsePoints = 2000;
constexpr Eigen::Index kLeastGain = 4;

/// Candidates are refined on the surface itself if their score on the coarse map is at most this
/// many times the best, or a quarter of a cell; and at most this many are.
constexpr double kRival = 3;
constexpr size_t kMaxRivals = 6;

/// Candidates fit equally well if their scores differ by at most this factor (or rounding); among
/// these the one that moves the points least is taken.
constexpr double kEqualScore = 1.2;

/// Like `kStayFar` of the search, but near the surface.
constexpr double kStayNear = 1e-3;

/// Refinement ends when a step moves the points by at most this (local frame), or by a tenth of the
/// standard error of their mean distance.
constexpr double kConverged = 1e-10;
constexpr double kOfMeanError = 0.1;

/// A step that does not reduce the loss is divided by this.
constexpr double kShorten = 4;

/// Motions to come are predicted, for `RegistrationTarget::Impl::pair`, as this share of the step
/// before, and after the refinement with some points as this share of the distances' deviation.
constexpr double kNextStep = 0.5;
constexpr double kFirstStep = 0.5;

/// The second derivative of the loss counts at least this share of the weights, so that steps are
/// at most twice those of weighted least squares.
constexpr double kLeastCurvature = 0.5;

void check_options(const RegistrationOptions& options) {
  static_cast<void>(in_range(options));
  if (!is_rigid(options.T_target_source_start)) {
    throw InvalidInput(
        "RegistrationOptions::T_target_source_start is not a rotation and a finite shift");
  }
}

Eigen::Matrix3Xd finite_points(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  Eigen::Matrix3Xd finite(3, points.cols());
  Eigen::Index count = 0;
  for (const auto& point : points.colwise()) {
    if (point.allFinite()) finite.col(count++) = point;
  }
  finite.conservativeResize(3, count);
  if (count < kMinPoints) {
    throw InvalidInput(
        fmt::format("register_points: {} of the {} points are finite; at least three are needed",
                    count, points.cols()));
  }
  return finite;
}

/// Objective of the refinement: the mean of Tukey's loss, 0 for a pair that fits and 1 beyond the
/// cut-off.
double mean_loss(const Eigen::VectorXd& distances, double deviation) {
  double sum = 0;
  for (const double distance : distances) {
    const double weight = tukey_weight(distance, deviation);
    sum += 1 - weight * std::sqrt(weight);
  }
  return sum / static_cast<double>(distances.size());
}

/// The start of a refinement.
struct Start {
  Eigen::Isometry3d motion;
  double slack = 0;  ///< see `RegistrationTarget::Impl::pair`, for the first step
};

/// Point-to-plane steps to the triangles. A step that does not reduce the loss is shortened, so
/// that the iteration also ends where noise and facets would make it oscillate.
SettledPose settle(const RegistrationTarget::Impl& target, const Eigen::Matrix3Xd& points,
                   const Start& start, double fraction, int max_iterations, WorkSteps& steps) {
  SettledPose pose{.motion = start.motion, .pairing = {}};
  TrackedPairing tracked;
  const Pairing& pairing = tracked.pairing;
  Eigen::Matrix3Xd moved = start.motion * points, tried;
  target.pair(moved, start.slack, tracked, steps);
  pose.deviation = inlier_deviation(target, pairing.distances, fraction);
  bool descends = true;
  while (pose.iterations < max_iterations) {
    const RigidProblem problem = rigid_problem(moved, pairing, pose.deviation);
    if (problem.used < kMinPoints) break;
    Vector6d x = solve(problem, kStayNear);
    // Newton's step: Tukey's loss has less curvature than its weights imply.
    x *= problem.weight / std::max(problem.curvature, kLeastCurvature * problem.weight);
    if (!x.allFinite()) break;
    const double mean_error =
        quantile(pairing.distances, 0.5) / std::sqrt(static_cast<double>(points.cols()));
    const double least_step = std::max(kConverged, kOfMeanError * mean_error);
    const double loss = mean_loss(pairing.distances, pose.deviation);
    Eigen::Isometry3d motion;
    for (descends = false; !descends; x /= kShorten) {
      pose.converged = x.norm() <= least_step;
      if (pose.converged || pose.iterations == max_iterations) break;
      ++pose.iterations;
      motion = to_motion(x, problem) * pose.motion;
      tried = motion * points;
      target.pair(tried, kNextStep * x.norm(), tracked, steps);
      descends = mean_loss(pairing.distances, pose.deviation) < loss;
    }
    if (!descends) break;
    pose.motion = motion;
    moved.swap(tried);
    // Never increase the scale: a loss that keeps changing has no minimum.
    pose.deviation =
        std::min(pose.deviation, inlier_deviation(target, pairing.distances, fraction));
  }
  if (!descends) target.pair(moved, 0, tracked, steps);  // back from where it does not descend
  pose.pairing = std::move(tracked.pairing);
  return pose;
}

/// The start of the refinement with all points: settled with some of them first, where most of the
/// steps are taken, unless these lose the surface.
Start settle_some(const RegistrationTarget::Impl& target, const Eigen::Matrix3Xd& points,
                  const Eigen::Isometry3d& start, const RegistrationOptions& options,
                  WorkSteps& steps) {
  if (points.cols() < kLeastGain * kCoarsePoints) return {start};
  const SettledPose pose = settle(target, spread_subset(points, kCoarsePoints), {start},
                                  options.min_overlap, options.max_iterations, steps);
  if (!pose.converged) return {start};
  return {pose.motion, kFirstStep * pose.deviation};
}

/// PCL pairs a point with a vertex at most this many deviations away, beyond which Tukey's weight
/// of a distance from the surface is 0, ...
constexpr double kPclDeviations = 5;
/// ... plus this many coarse cells, because a vertex can be farther away than the surface by up to
/// the length of a side.
constexpr double kPclCells = 2;

/// Refines with PCL's steps to the vertices.
SettledPose settle_with_pcl(const RegistrationTarget::Impl& target, const Eigen::Matrix3Xd& points,
                            const Eigen::Isometry3d& start, const RegistrationOptions& options,
                            WorkSteps& steps) {
  const Eigen::Matrix3Xd moved = start * points;
  const double deviation =
      inlier_deviation(target, target.pair(moved, steps).distances, options.min_overlap);
  const double max_distance = kPclDeviations * deviation + kPclCells * target.grid().cell_size();
  const VertexCloud::Outcome outcome = target.vertex_cloud().align(
      moved, options.method, max_distance, options.max_iterations, [&] { steps.tell(0); });
  SettledPose pose{.motion = outcome.motion * start, .pairing = {}};
  pose.converged = outcome.converged;
  pose.iterations = outcome.iterations;
  pose.pairing = target.pair(pose.motion * points, steps);
  pose.deviation = inlier_deviation(target, pose.pairing.distances, options.min_overlap);
  return pose;
}

/// The promising candidates of a search, refined on the surface itself.
struct Rivals {
  std::vector<PoseCandidate> poses;
  std::vector<double> medians;  ///< of each pose, see `median_distance`
};

Rivals refine_rivals(const RegistrationTarget::Impl& target, const Eigen::Matrix3Xd& some,
                     const PoseSearch& search, double fraction, WorkSteps& steps) {
  const double bound =
      std::max(kRival * search.candidates.front().score, target.grid().cell_size() / 4);
  Rivals rivals;
  for (const PoseCandidate& candidate : search.candidates) {
    if (candidate.score > bound || rivals.poses.size() == kMaxRivals) break;
    const SettledPose pose =
        settle(target, some, {candidate.motion}, fraction, kCandidateSteps, steps);
    const Eigen::VectorXd& distances = pose.pairing.distances;
    rivals.poses.push_back({pose.motion, quantile(distances, fraction)});
    rivals.medians.push_back(median_distance(distances, fraction));
  }
  return rivals;
}

/// The pose that fits best; of those that fit equally well, the one that moves the points least.
Eigen::Isometry3d best_of(const std::vector<PoseCandidate>& poses, const Eigen::Matrix3Xd& some) {
  double least = poses.front().score;
  for (const PoseCandidate& pose : poses) least = std::min(least, pose.score);
  Eigen::Isometry3d best = poses.front().motion;
  double least_motion = kInfinity;
  for (const PoseCandidate& pose : poses) {
    if (pose.score > kEqualScore * least + kConverged) continue;
    const double motion = mean_displacement(pose.motion, Eigen::Isometry3d::Identity(), some);
    if (motion >= least_motion) continue;
    least_motion = motion;
    best = pose.motion;
  }
  return best;
}

/// The median distance at the best pose that is not this one.
std::optional<double> best_other(const RegistrationTarget::Impl& target,
                                 const Eigen::Matrix3Xd& some, const PoseSearch& search,
                                 const Rivals& rivals, const Eigen::Isometry3d& chosen) {
  std::optional<double> best;
  for (size_t i = 0; i < search.candidates.size(); ++i) {
    const bool is_refined = i < rivals.poses.size();
    const PoseCandidate& other = is_refined ? rivals.poses[i] : search.candidates[i];
    const double apart = mean_displacement(other.motion, chosen, some);
    if (apart < kSamePose * target.grid().cell_size()) continue;
    best = std::min(best.value_or(kInfinity), is_refined ? rivals.medians[i] : other.score);
  }
  return best;
}

/// Returns the search range that contains the pose found, if the points moved beyond the range of
/// the search; nullopt if it was searched, or is near enough for the trials of the verdict.
std::optional<SearchRange> range_beyond(const SearchRange& searched, const Eigen::Matrix3Xd& points,
                                        const Eigen::Isometry3d& motion) {
  const Eigen::Vector3d centroid = points.rowwise().mean();
  const double radius = std::sqrt((points.colwise() - centroid).colwise().squaredNorm().mean());
  const double turn = Eigen::AngleAxisd(motion.linear()).angle() - searched.rotation;
  const double shift = (motion * centroid - centroid).norm() - searched.translation;
  // A start that is farther off than stated may be rotated farther or shifted farther, also to a
  // pose near it that fits by chance: at least the rotations of the default are searched.
  const double beyond = std::max(turn * radius, shift);
  if (!(beyond > kTrialLength * radius)) return std::nullopt;
  const double rotation =
      std::max(searched.rotation + beyond / radius, RegistrationOptions{}.search_rotation);
  return SearchRange{.rotation = std::min(std::numbers::pi, rotation),
                     .translation = searched.translation + beyond,
                     .quantile = searched.quantile};
}

/// Precondition: the options are valid.
Registration register_to(const RegistrationTarget::Impl& surface,
                         const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                         const RegistrationOptions& options) {
  Eigen::Matrix3Xd source = options.T_target_source_start * finite_points(points);
  source = in_spatial_order((source.colwise() - surface.centre) * surface.scale);

  Registration result;
  const SearchRange range{.rotation = options.search_rotation,
                          .translation = options.search_translation * surface.scale,
                          .quantile = options.min_overlap};
  WorkSteps steps(options.progress, kSteps);
  const Eigen::Matrix3Xd few = spread_subset(source, kSearchPoints);
  const Eigen::Matrix3Xd some = spread_subset(source, kCandidatePoints);
  Eigen::Isometry3d best = Eigen::Isometry3d::Identity();
  std::optional<double> runner_up;
  result.starts = 1;
  if (range.rotation > 0 || range.translation > 0) {
    const PoseSearch search = search_poses(surface, few, range, steps);
    const Rivals rivals = refine_rivals(surface, some, search, range.quantile, steps);
    result.starts = search.starts;
    best = best_of(rivals.poses, some);
    runner_up = best_other(surface, some, search, rivals, best);
    steps.tell();
  }
  SettledPose pose;
  if (options.method == RegistrationMethod::point_to_triangle) {
    const Start start = settle_some(surface, source, best, options, steps);
    steps.tell();
    pose = settle(surface, source, start, options.min_overlap, options.max_iterations, steps);
  } else {
    pose = settle_with_pcl(surface, source, best, options, steps);
  }
  steps.tell();
  result.T_target_source = surface.to_world(pose.motion) * options.T_target_source_start;
  result.iterations = pose.iterations;
  judge(surface, source, pose, runner_up, options, result);
  const std::optional<SearchRange> beyond = range_beyond(range, some, pose.motion);
  if (beyond && result.verdict == RegistrationVerdict::accepted) {
    const PoseSearch search = search_poses(surface, few, *beyond, steps);
    const Rivals rivals = refine_rivals(surface, some, search, range.quantile, steps);
    runner_up = best_other(surface, some, search, rivals, pose.motion);
    judge(surface, source, pose, runner_up, options, result);
  }
  steps.end();
  return result;
}

}  // namespace

void visit(RegistrationOptions& options, FieldVisitor& visitor) {
  constexpr bool kExpert = true;
  visitor.begin("RegistrationOptions");
  visitor.choice(
      {"method",
       "Method that refines the pose: point_to_triangle uses the triangles themselves and is the "
       "most accurate; point_to_plane (PCL's ICP with normals) suits fine meshes with little "
       "noise; point_to_point (PCL's ICP) needs no normals, but is limited by the spacing of the "
       "vertices"},
      options.method, kMethods);
  visitor.real(
      {"search_rotation",
       "Largest rotation from the start pose, about the centroid of what is registered", "rad"},
      options.search_rotation, at_least(0).at_most(std::numbers::pi));
  visitor.real({"search_translation",
                "Largest shift of that centroid from the start pose; inf: unknown, then what is "
                "registered must cover the surface or start close to its final place",
                "mm"},
               options.search_translation, at_least(0));
  visitor.real({"min_overlap",
                "Smallest share of what is registered that must lie on the surface; a pose with "
                "less is not accepted"},
               options.min_overlap, above(0).at_most(1));
  visitor.real({"max_rms",
                "Largest root mean square distance from the surface; a pose with more is not "
                "accepted",
                "mm", kExpert},
               options.max_rms, above(0));
  visitor.whole({"max_iterations", "Largest number of iterations of the refinement", "", kExpert},
                options.max_iterations, at_least(1));
}

Registration register_points(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                             const RegistrationTarget& target, const RegistrationOptions& options) {
  check_options(options);
  return register_to(target.impl(), points, options);
}

Registration register_points(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                             const TriangleMesh& target, const RegistrationOptions& options) {
  check_options(options);
  return register_to(RegistrationTarget::Impl(target, TargetUse::once), points, options);
}

TargetPlanes planes_at(const RegistrationTarget& target,
                       const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  const RegistrationTarget::Impl& surface = target.impl();
  Pairing pairing = surface.pair((points.colwise() - surface.centre) * surface.scale);
  return {.normals = std::move(pairing.normals),
          .heights = pairing.heights / surface.scale,
          .usable = std::move(pairing.usable)};
}

const char* to_string(RegistrationVerdict verdict) {
  switch (verdict) {
    case RegistrationVerdict::accepted:
      return "accepted";
    case RegistrationVerdict::not_converged:
      return "not_converged";
    case RegistrationVerdict::too_few_points:
      return "too_few_points";
    case RegistrationVerdict::little_overlap:
      return "little_overlap";
    case RegistrationVerdict::slides:
      return "slides";
    case RegistrationVerdict::ambiguous:
      return "ambiguous";
    case RegistrationVerdict::poor_fit:
      return "poor_fit";
  }
  return "unknown";
}

}  // namespace palpate::geometry
