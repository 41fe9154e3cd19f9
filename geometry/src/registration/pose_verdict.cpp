// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "registration/pose_verdict.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <vector>

#include "base/numbers.h"
#include "palpate/core/quantile.h"
#include "palpate/geometry/robust_weights.h"
#include "registration/pose_search.h"

namespace palpate::geometry {
namespace {

/// Distances below this fraction of the target's diagonal are rounding error.
constexpr double kLeastLength = 1e-6;

/// A point is an inlier if its distance is at most this many deviations.
constexpr double kInlierDeviations = 3;

/// The number of inliers must exceed the degrees of freedom that the surface fixes by this much;
/// fewer points fit anywhere.
constexpr int kSpareInliers = 10;

/// A motion is weak, and is tried, if it changes the distances to the planes by less than this
/// fraction of its length (root mean square): a relief of 18 degrees is sufficient.
constexpr double kWeakGain = 0.3;

/// A motion is free if in its trial the median distance increases by at most this fraction of the
/// trial's length.
constexpr double kFreeGrowth = 0.02;

/// If the median distance exceeds this fraction of the trial's length, the fit is too poor for a
/// decision.
constexpr double kFreeMedian = 0.25;

/// A pose stands out if at every trial, and at every other minimum, the median distance is larger
/// by at least the factor c (1 + (f / spare)^2), where spare is the number of inliers beyond six:
/// few points also fit a wrong place if many places are tested.
constexpr double kContrast = 2;
constexpr double kFew = 20;

constexpr Eigen::Index kTrialPoints = 200;

/// A motion that the planes hardly fix, and the median distance after it.
struct Trial {
  Vector6d motion;    ///< of unit length
  double median = 0;  ///< the smaller of both directions
};

double median_after(const RegistrationTarget::Impl& target, const Eigen::Matrix3Xd& moved,
                    const RigidProblem& problem, const Vector6d& motion, double min_overlap) {
  return median_distance(target.pair(to_motion(motion, problem) * moved).distances, min_overlap);
}

/// Returns motions, those that the planes fix least first.
std::vector<Trial> try_weak_motions(const RegistrationTarget::Impl& target,
                                    const Eigen::Matrix3Xd& moved, const RigidProblem& problem,
                                    double min_overlap) {
  // Points on a line can rotate about it without moving; this also counts as a motion.
  const Matrix6d lengths = problem.points + kLeastLength * problem.weight * Matrix6d::Identity();
  const Eigen::GeneralizedSelfAdjointEigenSolver<Matrix6d> gains(problem.planes, lengths);
  std::vector<Trial> trials;
  for (int k = 0; k < 6; ++k) {
    if (k > 0 && !(gains.eigenvalues()[k] < kWeakGain * kWeakGain)) break;
    const Vector6d unit = gains.eigenvectors().col(k) * std::sqrt(problem.weight);
    const Vector6d step = kTrialLength * problem.radius * unit;
    trials.push_back(
        {.motion = unit,
         .median = std::min(median_after(target, moved, problem, step, min_overlap),
                            median_after(target, moved, problem, -step, min_overlap))});
  }
  return trials;
}

/// Converts to the world's units: rotation in radians, translation in mm. A free motion gets the
/// size of the target as its uncertainty.
Matrix6d pose_covariance(const RigidProblem& problem, const std::vector<Vector6d>& free,
                         double variance, double diagonal, double scale) {
  Matrix6d fixed = Matrix6d::Identity();  // projects onto the motions that are fixed
  for (const Vector6d& motion : free) {
    const Vector6d unit = (fixed * motion).normalized();
    fixed -= unit * unit.transpose();
  }
  const Eigen::SelfAdjointEigenSolver<Matrix6d> solver(fixed * problem.planes * fixed);
  Matrix6d covariance = Matrix6d::Zero();
  for (int k = 0; k < 6; ++k) {
    const Vector6d direction = solver.eigenvectors().col(k);
    const double eigenvalue = solver.eigenvalues()[k];
    const bool is_fixed = eigenvalue * diagonal * diagonal > variance &&
                          eigenvalue > kLeastLength * kLeastLength * problem.weight;
    covariance += (is_fixed ? variance / eigenvalue : diagonal * diagonal) * direction *
                  direction.transpose();
  }
  Vector6d unit;
  unit << Eigen::Vector3d::Constant(1 / problem.radius), Eigen::Vector3d::Constant(1 / scale);
  return unit.asDiagonal() * covariance * unit.asDiagonal();
}

struct Verdict {
  RegistrationVerdict verdict;
  std::string reason;
};

Verdict decide(const SettledPose& pose, const std::vector<Trial>& trials, double least,
               double scale, const RegistrationOptions& options, const Registration& result) {
  using enum RegistrationVerdict;
  // If the points slide, the steps are small and many, so the sliding is reported as the cause.
  if (!pose.converged && result.free_motions.empty()) {
    return {not_converged,
            fmt::format("the steps had not settled after {} iterations{}", pose.iterations,
                        result.inliers < 3 ? ": no surface near the points" : "")};
  }
  if (result.overlap < options.min_overlap) {
    return {little_overlap,
            fmt::format("{:.0f} % of the points lie on the surface; at least {:.0f} % are needed",
                        100 * result.overlap, 100 * options.min_overlap)};
  }
  const int fixed = 6 - static_cast<int>(result.free_motions.size());
  if (result.inliers < fixed + kSpareInliers) {
    return {too_few_points, fmt::format("{} points on the surface; to judge a pose it takes {}",
                                        result.inliers, fixed + kSpareInliers)};
  }
  if (!(result.rms <= options.max_rms)) {
    return {poor_fit, fmt::format("the points lie {:.3g} mm from the surface (RMS); at most {:.3g} "
                                  "mm are allowed",
                                  result.rms, options.max_rms)};
  }
  if (!result.free_motions.empty()) {
    std::string motions;
    for (const FreeMotion& motion : result.free_motions) {
      motions += (motions.empty() ? "" : ", ") + motion.description;
    }
    return {slides, "the surface does not fix " + motions};
  }
  const double few = kFew / (result.inliers - fixed);
  const double outstanding = kContrast * (1 + few * few) * std::max(result.median, least);
  if (result.runner_up && *result.runner_up < outstanding) {
    return {ambiguous,
            fmt::format("another pose fits {}: median distance {:.3g} mm, here {:.3g} mm",
                        *result.runner_up < result.median ? "better" : "nearly as well",
                        *result.runner_up, result.median)};
  }
  for (const Trial& trial : trials) {
    if (trial.median / scale >= outstanding) continue;
    return {poor_fit, fmt::format("the points fit hardly better than a little beside: median "
                                  "distance {:.3g} mm, there {:.3g} mm",
                                  result.median, trial.median / scale)};
  }
  return {accepted,
          fmt::format("{:.0f} % of the points lie on the surface within {:.3g} mm (RMS); no other "
                      "pose that was tried fits as well",
                      100 * result.overlap, result.rms)};
}

/// How many points are at least near the surface, however poorly they fit.
struct Nearness {
  double distance = 0;  ///< [local frame] up to which a point counts as near
  double share = 0;
  double rms = 0;  ///< [local frame] of the near points; NaN without any
  int count = 0;
};

/// Whatever share `min_overlap` is, as many points are inliers if the deviation is as large as
/// their distances. Here the deviation is that of the nearer half of that share, within limits
/// relative to the points' size, so that a few wrong points are no surface.
Nearness nearness(const Eigen::VectorXd& distances, double min_overlap, double radius) {
  const double trial = kTrialLength * radius;
  Nearness near;
  near.distance =
      std::clamp(kInlierDeviations * deviation_of_median(quantile(distances, min_overlap / 2)),
                 kFreeMedian * trial, trial);
  double squares = 0;
  for (const double distance : distances) {
    if (!(distance <= near.distance)) continue;
    ++near.count;
    squares += distance * distance;
  }
  near.share = static_cast<double>(near.count) / static_cast<double>(distances.size());
  near.rms = near.count > 0 ? std::sqrt(squares / near.count) : kNan;
  return near;
}

/// Whether few near points explain this verdict.
bool is_vague(const Verdict& found, const SettledPose& pose, const RegistrationOptions& options,
              const std::optional<double>& runner_up, const Nearness& near) {
  using enum RegistrationVerdict;
  switch (found.verdict) {
    case not_converged:
      return pose.iterations < options.max_iterations;
    case ambiguous:  // the other pose may have the overlap that this one lacks
      return !(runner_up && *runner_up <= near.distance);
    default:
      return found.verdict == poor_fit;
  }
}

}  // namespace

std::string describe_motion(const Eigen::Vector3d& rotation, const Eigen::Vector3d& translation,
                            double radius) {
  const auto direction = [](const Eigen::Vector3d& v) {
    const Eigen::Vector3d unit = v.normalized();
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", unit.x(), unit.y(), unit.z());
  };
  constexpr double kMixed =
      0.1;  // a component is named if it moves the points by this share of the others
  const double turned = rotation.norm() * radius;
  const double shifted = translation.norm();
  if (turned < kMixed * shifted) return "a shift along " + direction(translation);
  if (shifted < kMixed * turned) return "a turn about " + direction(rotation);
  return "a turn about " + direction(rotation) + " with a shift along " + direction(translation);
}

double inlier_deviation(const RegistrationTarget::Impl& target, const Eigen::VectorXd& distances,
                        double fraction) {
  return std::max(deviation_of_median(quantile(distances, fraction)),
                  kLeastLength * target.diagonal);
}

double median_distance(const Eigen::VectorXd& distances, double min_overlap) {
  return quantile(distances, std::min(0.5, min_overlap));
}

void judge(const RegistrationTarget::Impl& target, const Eigen::Matrix3Xd& points,
           const SettledPose& pose, std::optional<double> runner_up,
           const RegistrationOptions& options, Registration& result) {
  const Eigen::Matrix3Xd moved = pose.motion * points;
  const Eigen::VectorXd& distances = pose.pairing.distances;
  result.inliers = 0;
  result.free_motions.clear();
  double squares = 0;
  for (const double distance : distances) {
    if (!(distance <= kInlierDeviations * pose.deviation)) continue;
    ++result.inliers;
    squares += distance * distance;
  }
  result.overlap = static_cast<double>(result.inliers) / static_cast<double>(distances.size());
  result.rms = result.inliers > 0 ? std::sqrt(squares / result.inliers) / target.scale : kNan;
  const double median = median_distance(distances, options.min_overlap);
  result.median = median / target.scale;
  if (runner_up) result.runner_up = *runner_up / target.scale;

  const RigidProblem problem = rigid_problem(moved, pose.pairing, pose.deviation);
  result.centre = target.centre + problem.centre / target.scale;
  std::vector<Trial> trials;
  std::vector<Vector6d> free;
  if (problem.used >= 3) {
    trials =
        try_weak_motions(target, spread_subset(moved, kTrialPoints), problem, options.min_overlap);
    const double length = kTrialLength * problem.radius;
    for (const Trial& trial : trials) {
      if (trial.median > median + kFreeGrowth * length || median > kFreeMedian * length) continue;
      FreeMotion motion;
      motion.rotation = kTrialLength * trial.motion.head<3>();
      motion.translation = length * trial.motion.tail<3>() / target.scale;
      motion.description =
          describe_motion(motion.rotation, motion.translation, problem.radius / target.scale);
      result.free_motions.push_back(motion);
      free.push_back(trial.motion);
    }
  }
  const double variance = squares / std::max(1, result.inliers - 6);
  result.covariance = pose_covariance(problem, free, variance, target.diagonal, target.scale);
  Verdict verdict = decide(pose, trials, kLeastLength * target.diagonal / target.scale,
                           target.scale, options, result);
  const Nearness near = nearness(distances, options.min_overlap, problem.radius);
  if (near.share < options.min_overlap && is_vague(verdict, pose, options, runner_up, near)) {
    result.inliers = near.count;
    result.overlap = near.share;
    result.rms = near.rms / target.scale;
    verdict = {
        RegistrationVerdict::little_overlap,
        fmt::format("{:.0f} % of the points lie within {:.3g} mm of the surface; at least "
                    "{:.0f} % are needed",
                    100 * near.share, near.distance / target.scale, 100 * options.min_overlap)};
  }
  result.verdict = verdict.verdict;
  result.reason = verdict.reason;
}

}  // namespace palpate::geometry
