// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_distance.h"

#include <cmath>

#include "base/numbers.h"
#include "clouds/known_points.h"
#include "clouds/point_tree.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/core/work_steps.h"

namespace palpate::geometry {

Eigen::VectorXd distances_to_cloud(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                   const Eigen::Ref<const Eigen::Matrix3Xd>& cloud,
                                   const WorkSteps::Progress& progress) {
  const std::vector<int> known = known_points(points);
  const PointTree tree(cloud);
  if (tree.places().empty())
    throw InvalidInput("distances_to_cloud: none of the " + std::to_string(cloud.cols()) +
                       " points of the cloud is known; at least one is needed");
  Eigen::VectorXd distances = Eigen::VectorXd::Constant(points.cols(), kNan);
  const auto all = static_cast<int>(known.size());
  WorkSteps steps(progress, all + 1);
  in_reported_parts(all, steps, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    std::vector<Neighbour> found;
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      const int point = known[static_cast<std::size_t>(i)];
      tree.nearest(points.col(point), 1, found);
      distances[point] = std::sqrt(found.front().squared_distance);
    }
  });
  steps.end();
  return distances;
}

Eigen::VectorXd neighbour_distances(const Eigen::Ref<const Eigen::Matrix3Xd>& points, int count,
                                    const WorkSteps::Progress& progress) {
  require("neighbour_distances: count", count, at_least(1).at_most(kMostNeighbours));
  const PointTree tree(points);
  Eigen::VectorXd distances = Eigen::VectorXd::Constant(points.cols(), kNan);
  // One more, because each point is the nearest to itself, or another one at the same place is.
  const auto others = static_cast<std::size_t>(count);
  WorkSteps steps(progress, static_cast<int>(tree.places().size()) + 1);
  for_each_neighbourhood(tree, count + 1, steps,
                         [&](const PointTree::Place& place, const std::vector<Neighbour>& found) {
                           distances[place.point] = found.size() > others
                                                        ? std::sqrt(found[others].squared_distance)
                                                        : kInfinity;
                         });
  steps.end();
  return distances;
}

}  // namespace palpate::geometry
