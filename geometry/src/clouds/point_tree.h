// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "palpate/core/parallel_for.h"
#include "palpate/core/work_steps.h"

namespace palpate::geometry {

struct Neighbour {
  double squared_distance = 0;  ///< [mm^2]
  int point = 0;                ///< index of the point in the cloud
};

/// Nearest points of a cloud in double precision: a balanced k-d tree (Friedman, Bentley and Finkel
/// 1977), built by all threads. Points that are not finite are left out. The distances are those of
/// a search through all points; of points at the same distance any may be found, but always the
/// same ones.
class PointTree {
 public:
  /// \throws InvalidInput as `known_points`.
  explicit PointTree(const Eigen::Ref<const Eigen::Matrix3Xd>& points);

  /// Finds the `count` points nearest to `point`, or all if there are fewer; nearest first. Reuses
  /// the memory of `found`. Precondition: a finite point.
  void nearest(const Eigen::Vector3d& point, int count, std::vector<Neighbour>& found) const;

  struct Place {
    Eigen::Vector3d position;
    int point;  ///< its index in the cloud
  };
  /// The points in the order of the tree, in which neighbours are near each other: to search for
  /// all of them in this order takes a fraction of the time of a random one.
  [[nodiscard]] const std::vector<Place>& places() const { return places_; }

 private:
  struct Search;
  void split_level(const std::vector<int>& bounds, std::size_t first_node);
  void descend(Search& search, std::size_t node, int begin, int end) const;

  /// An inner node; below node i are the nodes 2 i + 1 and 2 i + 2, or leaves.
  struct Node {
    double low_end;     ///< largest coordinate of the lower half along the axis
    double high_begin;  ///< smallest coordinate of the upper half
    std::uint8_t axis;
  };

  std::vector<Place> places_;  ///< those of a leaf side by side
  std::vector<Node> nodes_;
  Eigen::Vector3d low_, high_;  ///< corners of the box of all points
};

/// Calls `body(begin, end)` for ranges of [0, count), on all threads, and reports after each part.
/// \param steps counts to `count`.
template <typename Body>
void in_reported_parts(std::ptrdiff_t count, WorkSteps& steps, const Body& body) {
  constexpr std::ptrdiff_t kGrain = 256, kReport = 50'000;
  for (std::ptrdiff_t first = 0; first < count; first += kReport) {
    const std::ptrdiff_t part = std::min(kReport, count - first);
    parallel_ranges(part, kGrain, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      body(first + begin, first + end);
    });
    steps.tell(static_cast<int>(part));
  }
}

/// Calls `body(place, found)` for each point of the tree with the `count` points nearest to it
/// (itself among them), on all threads.
/// \param steps counts the points.
template <typename Body>
void for_each_neighbourhood(const PointTree& tree, int count, WorkSteps& steps, const Body& body) {
  const std::vector<PointTree::Place>& places = tree.places();
  in_reported_parts(static_cast<std::ptrdiff_t>(places.size()), steps,
                    [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
                      std::vector<Neighbour> found;
                      for (std::ptrdiff_t i = begin; i < end; ++i) {
                        const PointTree::Place& place = places[static_cast<std::size_t>(i)];
                        tree.nearest(place.position, count, found);
                        body(place, found);
                      }
                    });
}

}  // namespace palpate::geometry
