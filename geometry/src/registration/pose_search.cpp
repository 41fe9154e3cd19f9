// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "registration/pose_search.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/numbers.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"
#include "palpate/geometry/robust_weights.h"

namespace palpate::geometry {
namespace {

/// [rad] largest distance between neighbouring rotations of the starts along each axis.
constexpr double kRotationStep = 25 * std::numbers::pi / 180;

/// Largest distance between neighbouring shifts of the starts along each axis: fraction of the
/// diagonal.
constexpr double kShiftStep = 0.1;

/// Rounds of the search: number of steps of each candidate, and share of the candidates kept for
/// the next round.
struct Round {
  int steps;
  double kept;
};
constexpr std::array<Round, kSearchRounds> kRounds = {{{2, 0.34}, {4, 0.5}, {6, 1}}};
/// Candidates between two reports.
constexpr size_t kReport = 1000;
/// Smallest number of candidates kept.
constexpr size_t kLeastKept = 12;

/// Weight of the term against motion along the surface: far from it its planes mislead.
constexpr double kStayFar = 0.05;

/// The vectors k * step, k integers, within `range`, where step divides `range` and is at most
/// `largest_step`.
std::vector<Eigen::Vector3d> lattice(double range, double largest_step) {
  const int reach = static_cast<int>(std::ceil(range / largest_step));
  const double step = reach > 0 ? range / reach : 0;
  std::vector<Eigen::Vector3d> vectors;
  for (int x = -reach; x <= reach; ++x) {
    for (int y = -reach; y <= reach; ++y) {
      for (int z = -reach; z <= reach; ++z) {
        if (x * x + y * y + z * z <= reach * reach)
          vectors.push_back(step * Eigen::Vector3d(x, y, z));
      }
    }
  }
  return vectors;
}

Eigen::Matrix3d rotation_of(const Eigen::Vector3d& vector) {
  const double angle = vector.norm();
  if (!(angle > 0)) return Eigen::Matrix3d::Identity();
  return Eigen::AngleAxisd(angle, vector / angle).toRotationMatrix();
}

/// Translations of the points' centroid, which is `to_centroid` from the target's.
std::vector<Eigen::Vector3d> start_shifts(const Eigen::Vector3d& to_centroid, double range,
                                          double diagonal) {
  std::vector<Eigen::Vector3d> shifts =
      std::isfinite(range) ? lattice(std::min(range, diagonal / 2), kShiftStep * diagonal)
                           : lattice(0, 1);
  const double distance = to_centroid.norm();
  if (range > 0 && distance > 0) {
    shifts.emplace_back(to_centroid * std::min(1.0, range / distance));
  }
  return shifts;
}

/// Does steps on the coarse map; the score is that of the last pose.
void descend(const RegistrationTarget::Impl& target, const Eigen::Matrix3Xd& points,
             double fraction, int steps, PoseCandidate& candidate) {
  Pairing pairing;
  pairing.resize(points.cols());
  Eigen::Matrix3Xd moved = candidate.motion * points;
  target.pair_coarsely(moved, pairing);
  candidate.score = quantile(pairing.distances, fraction);
  for (int step = 0; step < steps; ++step) {
    const double deviation =
        std::max(deviation_of_median(candidate.score), target.grid().cell_size() / 2);
    const RigidProblem problem = rigid_problem(moved, pairing, deviation);
    if (problem.used < 3) return;
    const Vector6d x = solve(problem, kStayFar);
    if (!x.allFinite()) return;
    candidate.motion = to_motion(x, problem) * candidate.motion;
    moved = candidate.motion * points;
    target.pair_coarsely(moved, pairing);
    candidate.score = quantile(pairing.distances, fraction);
    if (x.norm() < target.grid().cell_size() / 100) return;
  }
}

/// Sorts candidates, best first; ties keep their order.
void sort_by_score(std::vector<PoseCandidate>& candidates) {
  std::stable_sort(
      candidates.begin(), candidates.end(),
      [](const PoseCandidate& a, const PoseCandidate& b) { return a.score < b.score; });
}

}  // namespace

Eigen::Matrix3Xd spread_subset(const Eigen::Matrix3Xd& points, Eigen::Index count) {
  if (points.cols() <= count) return points;
  Eigen::Matrix3Xd subset(3, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    // Multiples of the golden ratio, modulo one, are never far from evenly spread.
    const double place = std::fmod((static_cast<double>(i) + 0.5) * std::numbers::phi, 1.0);
    subset.col(i) = points.col(std::min(
        points.cols() - 1, static_cast<Eigen::Index>(place * static_cast<double>(points.cols()))));
  }
  return subset;
}

double mean_displacement(const Eigen::Isometry3d& one, const Eigen::Isometry3d& another,
                         const Eigen::Matrix3Xd& points) {
  return (one * points - another * points).colwise().norm().mean();
}

PoseSearch search_poses(const RegistrationTarget::Impl& target, const Eigen::Matrix3Xd& points,
                        const SearchRange& range, WorkSteps& steps) {
  const Eigen::Vector3d centroid = points.rowwise().mean();
  std::vector<PoseCandidate> candidates;
  for (const Eigen::Vector3d& shift :
       start_shifts(target.grid().centroid() - centroid, range.translation, target.diagonal)) {
    for (const Eigen::Vector3d& turn : lattice(range.rotation, kRotationStep)) {
      const Eigen::Matrix3d rotation = rotation_of(turn);
      PoseCandidate start;
      start.motion.linear() = rotation;
      start.motion.translation() = centroid + shift - rotation * centroid;
      candidates.push_back(start);
    }
  }
  PoseSearch search;
  search.starts = static_cast<int>(candidates.size());
  for (const Round& round : kRounds) {
    for (size_t first = 0; first < candidates.size(); first += kReport) {
      parallel_for(std::min(kReport, candidates.size() - first), [&](size_t i) {
        descend(target, points, range.quantile, round.steps, candidates[first + i]);
      });
      steps.tell(0);
    }
    steps.tell();
    sort_by_score(candidates);
    const auto kept =
        static_cast<size_t>(std::ceil(round.kept * static_cast<double>(candidates.size())));
    candidates.resize(std::min(candidates.size(), std::max(kept, kLeastKept)));
  }
  for (const PoseCandidate& candidate : candidates) {
    const bool is_new = std::none_of(
        search.candidates.begin(), search.candidates.end(), [&](const PoseCandidate& known) {
          return mean_displacement(known.motion, candidate.motion, points) <
                 kSamePose * target.grid().cell_size();
        });
    if (is_new) search.candidates.push_back(candidate);
  }
  return search;
}

}  // namespace palpate::geometry
