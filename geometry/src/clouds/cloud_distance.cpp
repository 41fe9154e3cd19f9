// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_distance.h"

#include <cmath>

#include "base/numbers.h"
#include "clouds/known_points.h"
#include "clouds/point_tree.h"
#include "palpate/error.h"
#include "palpate/require.h"

namespace palpate::geometry {

Eigen::VectorXd distances_to_cloud(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                   const Eigen::Ref<const Eigen::Matrix3Xd>& cloud) {
  const std::vector<int> known = known_points(points);
  const PointTree tree(cloud);
  if (tree.places().empty())
    throw InvalidInput("distances_to_cloud: none of the " + std::to_string(cloud.cols()) +
                       " points of the cloud is known; at least one is needed");
  Eigen::VectorXd distances = Eigen::VectorXd::Constant(points.cols(), kNan);
  constexpr std::ptrdiff_t kGrain = 256;
  parallel_ranges(static_cast<std::ptrdiff_t>(known.size()), kGrain,
                  [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
                    std::vector<Neighbour> found;
                    for (std::ptrdiff_t i = begin; i < end; ++i) {
                      const int point = known[static_cast<std::size_t>(i)];
                      tree.nearest(points.col(point), 1, found);
                      distances[point] = std::sqrt(found.front().squared_distance);
                    }
                  });
  return distances;
}

Eigen::VectorXd neighbour_distances(const Eigen::Ref<const Eigen::Matrix3Xd>& points, int count) {
  require("neighbour_distances: count", count, at_least(1).at_most(kMostNeighbours));
  const PointTree tree(points);
  Eigen::VectorXd distances = Eigen::VectorXd::Constant(points.cols(), kNan);
  // One more, because each point is the nearest to itself, or another one at the same place is.
  const auto others = static_cast<std::size_t>(count);
  const WorkSteps::Progress nobody_asks;
  WorkSteps steps(nobody_asks, 1);
  for_each_neighbourhood(tree, count + 1, steps,
                         [&](const PointTree::Place& place, const std::vector<Neighbour>& found) {
                           distances[place.point] = found.size() > others
                                                        ? std::sqrt(found[others].squared_distance)
                                                        : kInfinity;
                         });
  return distances;
}

}  // namespace palpate::geometry
