// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_outliers.h"

#include <cmath>

#include "base/numbers.h"
#include "clouds/point_tree.h"
#include "palpate/core/fields.h"
#include "palpate/geometry/cloud_distance.h"

namespace palpate::geometry {
namespace {

/// Mean distance of each point from its neighbours; NaN for unknown points.
Eigen::VectorXd mean_distances(const PointTree& tree, Eigen::Index points, int neighbours,
                               WorkSteps& steps) {
  Eigen::VectorXd means = Eigen::VectorXd::Constant(points, kNan);
  for_each_neighbourhood(tree, neighbours + 1, steps,
                         [&](const PointTree::Place& place, const std::vector<Neighbour>& found) {
                           double sum = 0;  // with the distance from itself, which is 0
                           for (const Neighbour& other : found)
                             sum += std::sqrt(other.squared_distance);
                           means[place.point] = sum / static_cast<double>(found.size() - 1);
                         });
  return means;
}

std::vector<int> up_to(const Eigen::VectorXd& values, double most) {
  std::vector<int> kept;
  for (Eigen::Index i = 0; i < values.size(); ++i) {
    if (values[i] <= most) kept.push_back(static_cast<int>(i));
  }
  return kept;
}

}  // namespace

void visit(OutlierOptions& options, FieldVisitor& visitor) {
  visitor.begin("OutlierOptions");
  visitor.whole({"neighbours",
                 "Number of nearest points whose mean distance is that of a point from its "
                 "neighbours; fewer if there are fewer others",
                 "", true, "outlier-neighbours"},
                options.neighbours, at_least(1).at_most(kMostNeighbours));
  visitor.real({"max_deviations",
                "Leave out points whose distance from their neighbours exceeds the mean of that of "
                "all points by more than this number of its standard deviations; 2 or 3 are usual",
                "", false, "outliers"},
               options.max_deviations, above(0));
}

std::vector<int> without_outliers(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                  const OutlierOptions& options) {
  static_cast<void>(in_range(options));
  const PointTree tree(points);
  constexpr std::size_t kFewest = 3;  // two points are each other's neighbours: equally far
  if (tree.places().size() < kFewest) return up_to(neighbour_distances(points), kInfinity);
  WorkSteps steps(options.progress, static_cast<int>(tree.places().size()) + 1);
  const Eigen::VectorXd distances = mean_distances(tree, points.cols(), options.neighbours, steps);
  steps.end();
  double sum = 0, count = 0;
  for (const double distance : distances) {
    if (std::isnan(distance)) continue;
    sum += distance;
    ++count;
  }
  const double mean = sum / count;
  double squares = 0;
  for (const double distance : distances) {
    if (!std::isnan(distance)) squares += (distance - mean) * (distance - mean);
  }
  // Distances that are equal up to rounding are all usual.
  constexpr double kRounding = 1e-12;
  return up_to(distances,
               mean * (1 + kRounding) + options.max_deviations * std::sqrt(squares / (count - 1)));
}

std::vector<int> without_isolated(const Eigen::Ref<const Eigen::Matrix3Xd>& points, double radius,
                                  int neighbours, const WorkSteps::Progress& progress) {
  require("without_isolated: radius", radius, above(0).finite(), "mm");
  return up_to(neighbour_distances(points, neighbours, progress), radius);
}

}  // namespace palpate::geometry
