// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "clouds/point_tree.h"

#include <algorithm>
#include <tuple>

#include "base/numbers.h"
#include "clouds/known_points.h"

namespace palpate::geometry {
namespace {

/// Points of a leaf: fewer take more steps down, more take more distances.
constexpr int kLeafSize = 12;

using Place = PointTree::Place;

int axis_of_largest_extent(const Place* begin, const Place* end) {
  Eigen::Array3d low = begin->position.array(), high = low;
  for (const Place* place = begin + 1; place < end; ++place) {
    low = low.min(place->position.array());
    high = high.max(place->position.array());
  }
  int axis = 0;
  (high / 2 - low / 2).maxCoeff(&axis);  // halves, because the whole extent may overflow
  return axis;
}

int middle(int begin, int end) { return begin + (end - begin) / 2; }

}  // namespace

/// One search for the nearest points.
struct PointTree::Search {
  Eigen::Vector3d point;
  std::size_t count;
  std::vector<Neighbour>& found;  ///< nearest first
  double worst = kInfinity;       ///< squared distance beyond which nothing is wanted
  Eigen::Vector3d gap = Eigen::Vector3d::Zero();  ///< along each axis from the current node's box
  double squared_gap = 0;

  void offer(double squared_distance, int index) {
    if (found.size() == count) found.pop_back();
    auto place = found.end();
    while (place != found.begin() && squared_distance < (place - 1)->squared_distance) --place;
    found.insert(place, {squared_distance, index});
    if (found.size() == count) worst = found.back().squared_distance;
  }
};

PointTree::PointTree(const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  const std::vector<int> known = known_points(points);
  places_.reserve(known.size());
  for (const int i : known) places_.push_back({points.col(i), i});
  std::vector<int> bounds = {0, static_cast<int>(places_.size())};
  low_.setConstant(kInfinity);
  high_.setConstant(-kInfinity);
  for (const Place& place : places_) {
    low_ = low_.cwiseMin(place.position);
    high_ = high_.cwiseMax(place.position);
  }
  while (bounds[1] - bounds[0] > kLeafSize) {
    const std::size_t first_node = nodes_.size();
    nodes_.resize(first_node + bounds.size() - 1);
    split_level(bounds, first_node);
    std::vector<int> halved = {0};
    for (std::size_t i = 1; i < bounds.size(); ++i) {
      halved.push_back(middle(bounds[i - 1], bounds[i]));
      halved.push_back(bounds[i]);
    }
    bounds = std::move(halved);
  }
}

void PointTree::split_level(const std::vector<int>& bounds, std::size_t first_node) {
  parallel_for(bounds.size() - 1, [&](std::size_t i) {
    Place* const begin = places_.data() + bounds[i];
    Place* const end = places_.data() + bounds[i + 1];
    Place* const half = places_.data() + middle(bounds[i], bounds[i + 1]);
    const int axis = axis_of_largest_extent(begin, end);
    std::nth_element(begin, half, end, [axis](const Place& a, const Place& b) {
      return std::tie(a.position[axis], a.point) < std::tie(b.position[axis], b.point);
    });
    const Place* const last = std::max_element(begin, half, [axis](const Place& a, const Place& b) {
      return a.position[axis] < b.position[axis];
    });
    nodes_[first_node + i] = {.low_end = last->position[axis],
                              .high_begin = half->position[axis],
                              .axis = static_cast<std::uint8_t>(axis)};
  });
}

void PointTree::nearest(const Eigen::Vector3d& point, int count,
                        std::vector<Neighbour>& found) const {
  found.clear();
  if (places_.empty() || count < 1) return;
  Search search{.point = point, .count = static_cast<std::size_t>(count), .found = found};
  search.gap = (low_ - point).cwiseMax(point - high_).cwiseMax(0);
  search.squared_gap = search.gap.squaredNorm();
  descend(search, 0, 0, static_cast<int>(places_.size()));
}

void PointTree::descend(Search& search, std::size_t node, int begin, int end) const {
  if (node >= nodes_.size()) {
    for (int i = begin; i < end; ++i) {
      const Place& place = places_[static_cast<std::size_t>(i)];
      const double squared = (place.position - search.point).squaredNorm();
      if (search.found.size() < search.count || squared < search.worst)
        search.offer(squared, place.point);
    }
    return;
  }
  const auto [low_end, high_begin, axis] = nodes_[node];
  const double past_low = search.point[axis] - low_end;
  const double to_high = high_begin - search.point[axis];
  const int half = middle(begin, end);
  const bool is_above = past_low > to_high;  // nearer to the upper half
  const std::size_t below = 2 * node + 1, above = 2 * node + 2;
  if (is_above)
    descend(search, above, half, end);
  else
    descend(search, below, begin, half);
  double& gap = search.gap[axis];
  const double gap_here = gap, squared_here = search.squared_gap;
  gap = is_above ? past_low : to_high;
  search.squared_gap = search.gap.squaredNorm();
  if (search.found.size() < search.count || search.squared_gap < search.worst) {
    if (is_above)
      descend(search, below, begin, half);
    else
      descend(search, above, half, end);
  }
  gap = gap_here;
  search.squared_gap = squared_here;
}

}  // namespace palpate::geometry
