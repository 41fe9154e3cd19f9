// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

#include "palpate/core/parallel_for.h"
#include "palpate/core/work_steps.h"
#include "palpate/geometry/cloud_shapes.h"
#include "query/local_frame.h"

namespace palpate::geometry {

/// Random numbers out of a counter: the finaliser of SplitMix64 (Steele, Lea and Flood 2014).
class CountedRandom {
 public:
  CountedRandom(std::uint64_t seed, std::uint64_t stream) : state_(mixed(seed) + mixed(~stream)) {}
  /// In [0, count).
  int below(int count) {
    state_ += 0x9e3779b97f4a7c15U;
    return static_cast<int>((mixed(state_) >> 32U) * static_cast<std::uint64_t>(count) >> 32U);
  }

 private:
  static std::uint64_t mixed(std::uint64_t value) {
    value = (value ^ (value >> 30U)) * 0xbf58476d1ce4e5b9U;
    value = (value ^ (value >> 27U)) * 0x94d049bb133111ebU;
    return value ^ (value >> 31U);
  }
  std::uint64_t state_;
};

/// The known points of a cloud in a local frame, and the options converted to it.
struct ShapeSearch {
  std::vector<int> known;  ///< their indices
  LocalFrame frame{};
  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xd judges;  ///< some of the points, by which proposals are compared
  double tolerance = 0;
  double max_radius = 0;
  int least = 0;  ///< points that a shape needs
  double min_share = 0;
  std::uint64_t seed = 0;
  WorkSteps::Progress progress;

  [[nodiscard]] int size() const { return static_cast<int>(known.size()); }
};

/// Checks the options. `points` and later members are empty for fewer than `sample` points.
[[nodiscard]] ShapeSearch prepare_search(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                         const CloudShapeOptions& options, int sample);

/// Number of samples of `size` points that it takes until one of them is on a shape that has this
/// share of the points, except with a probability of 1e-3; at most 1e6.
[[nodiscard]] double trials_needed(double share, int size);

template <typename Model>
struct FoundShape {
  Model model;
  std::vector<int> inliers;  ///< columns of ShapeSearch::points
};

/// The columns within the tolerance of a shape.
template <typename Model>
[[nodiscard]] std::vector<int> inliers_of(const ShapeSearch& search, const Model& model) {
  std::vector<int> inliers;
  for (int i = 0; i < search.points.cols(); ++i) {
    if (model.distance(search.points.col(i)) <= search.tolerance) inliers.push_back(i);
  }
  return inliers;
}

/// Fits a shape to the points within the tolerance until they no longer change.
template <typename Model>
[[nodiscard]] FoundShape<Model> refined(const ShapeSearch& search, const Model& proposal) {
  constexpr int kMostFits = 30;
  FoundShape<Model> shape{.model = proposal, .inliers = inliers_of(search, proposal)};
  for (int fit = 0; fit < kMostFits; ++fit) {
    const Eigen::Matrix3Xd on_it = search.points(Eigen::all, shape.inliers);
    const std::optional<Model> better = fitted(shape.model, on_it);
    if (!better) break;
    std::vector<int> inliers = inliers_of(search, *better);
    shape.model = *better;
    const bool is_settled = inliers == shape.inliers;
    shape.inliers = std::move(inliers);
    if (is_settled) break;
  }
  return shape;
}

/// Samples, compares, refines. `propose(random)` samples `sample` points and is the shape through
/// them, if any.
template <typename Model, typename Propose>
[[nodiscard]] std::optional<FoundShape<Model>> search_shape(const ShapeSearch& search, int sample,
                                                            const Propose& propose) {
  if (search.size() < search.least || search.points.cols() == 0) return std::nullopt;
  constexpr int kBatch = 128;  // trials between two updates of the number needed
  struct Trial {
    std::optional<Model> model;
    double score = 0;
  };
  const auto tried = [&](std::uint64_t number) {
    CountedRandom random(search.seed, number);
    Trial trial{.model = propose(random)};
    if (!trial.model) return trial;
    for (const auto& judge : search.judges.colwise()) {
      const double relative = trial.model->distance(judge) / search.tolerance;
      if (!(relative <= 1)) continue;
      trial.score += 1 - relative * relative;
    }
    return trial;
  };
  Trial best;
  double needed = trials_needed(search.min_share, sample);
  WorkSteps steps(search.progress, static_cast<int>(std::ceil(needed / kBatch)) + 1);
  std::array<Trial, kBatch> batch;
  for (double done = 0; done < needed; done += kBatch) {
    // Number 0 has chosen the judges.
    parallel_for(kBatch, [&](int i) {
      batch[static_cast<std::size_t>(i)] =
          tried(static_cast<std::uint64_t>(done) + 1 + static_cast<std::uint64_t>(i));
    });
    for (const Trial& trial : batch) {
      if (trial.score > best.score) best = trial;
    }
    // The score counts each inlier as at most one.
    const double share = best.score / static_cast<double>(search.judges.cols());
    if (share > search.min_share) needed = std::min(needed, trials_needed(share, sample));
    steps.tell();
  }
  std::optional<FoundShape<Model>> shape;
  if (best.model) shape = refined(search, *best.model);
  steps.end();
  if (shape && static_cast<int>(shape->inliers.size()) < search.least) return std::nullopt;
  return shape;
}

}  // namespace palpate::geometry
