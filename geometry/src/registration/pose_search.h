// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <vector>

#include "palpate/core/work_steps.h"
#include "registration/registration_target.h"

namespace palpate::geometry {

/// Poses are equal if the points differ by at most this many cells of the coarse map on average.
inline constexpr double kSamePose = 2;

/// A pose and its score.
struct PoseCandidate {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  double score = 0;  ///< quantile of the distances from the surface
};

struct PoseSearch {
  std::vector<PoseCandidate> candidates;  ///< distinct poses, the best first
  int starts = 0;
};

/// Range of the search, in the local frame.
struct SearchRange {
  double rotation = 0;     ///< [rad]
  double translation = 0;  ///< of the centroid
  double quantile = 0.5;   ///< fraction of the points that must fit
};

/// Selects at most `count` points for a stage, spread evenly over the order of the points and not
/// aligned with the rows of an image.
[[nodiscard]] Eigen::Matrix3Xd spread_subset(const Eigen::Matrix3Xd& points, Eigen::Index count);

/// [local frame] Mean distance between the positions of points under two poses.
[[nodiscard]] double mean_displacement(const Eigen::Isometry3d& one,
                                       const Eigen::Isometry3d& another,
                                       const Eigen::Matrix3Xd& points);

/// Number of rounds of a search, each of which is a step of its work.
inline constexpr int kSearchRounds = 3;

/// Finds minima of the distance of points from the target on its coarse map, from many starts.
[[nodiscard]] PoseSearch search_poses(const RegistrationTarget::Impl& target,
                                      const Eigen::Matrix3Xd& points, const SearchRange& range,
                                      WorkSteps& steps);

}  // namespace palpate::geometry
