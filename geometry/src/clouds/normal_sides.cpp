// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "clouds/normal_sides.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>
#include <vector>

#include "base/disjoint_sets.h"

namespace palpate::geometry {
namespace {

/// Neighbours of a point in the graph. More make it slower, not better: the tree uses one.
constexpr int kMostLinks = 8;

struct Link {
  double squared_length;  ///< [mm^2]
  float difference;       ///< 1 - |n_a . n_b|
  int a, b;               ///< points, a < b
};

std::vector<Link> links_of(const PointTree& tree, int neighbours, const Eigen::Matrix3Xd& normals,
                           WorkSteps& steps) {
  const int count = std::min(neighbours, kMostLinks) + 1;
  const auto stride = static_cast<std::size_t>(count);
  std::vector<Link> links(static_cast<std::size_t>(normals.cols()) * stride, Link{0, 0, 0, 0});
  for_each_neighbourhood(
      tree, count, steps, [&](const PointTree::Place& place, const std::vector<Neighbour>& found) {
        Link* link = links.data() + static_cast<std::size_t>(place.point) * stride;
        for (const Neighbour& other : found) {
          const double alike = std::abs(normals.col(place.point).dot(normals.col(other.point)));
          if (other.point == place.point || std::isnan(alike)) continue;
          *link++ = {.squared_length = other.squared_distance,
                     .difference = static_cast<float>(1 - alike),
                     .a = std::min(place.point, other.point),
                     .b = std::max(place.point, other.point)};
        }
      });
  std::erase_if(links, [](const Link& link) { return link.a == link.b; });
  std::sort(links.begin(), links.end(), [](const Link& x, const Link& y) {
    return std::tie(x.difference, x.squared_length, x.a, x.b) <
           std::tie(y.difference, y.squared_length, y.a, y.b);
  });
  return links;
}

/// For each point the lowest of its part, and whether its normal has to be turned to match that
/// one's. Kruskal's tree: of all links in ascending order, those that join two parts.
struct Part {
  int root;
  bool turned;
};
std::vector<Part> join_parts(const std::vector<Link>& links, const Eigen::Matrix3Xd& normals) {
  SignedSets sets(static_cast<int>(normals.cols()));
  for (const Link& link : links)
    sets.join(link.a, link.b, normals.col(link.a).dot(normals.col(link.b)) < 0);
  std::vector<Part> parts;
  parts.reserve(static_cast<std::size_t>(normals.cols()));
  for (int i = 0; i < normals.cols(); ++i) {
    const auto [root, turned] = sets.root_of(i);
    parts.push_back({root, turned});
  }
  return parts;
}

}  // namespace

void turn_to_one_side(const PointTree& tree, const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                      int neighbours, Eigen::Matrix3Xd& normals, WorkSteps& steps) {
  const std::vector<Part> parts = join_parts(links_of(tree, neighbours, normals, steps), normals);
  const auto part_of = [&](Eigen::Index i) { return parts[static_cast<std::size_t>(i)]; };
  Eigen::Matrix3Xd centroid = Eigen::Matrix3Xd::Zero(3, points.cols());
  Eigen::VectorXd count = Eigen::VectorXd::Zero(points.cols());
  Eigen::VectorXd outwards = Eigen::VectorXd::Zero(points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Part part = part_of(i);
    if (part.turned) normals.col(i) *= -1;
    if (!normals.col(i).allFinite()) continue;
    // Relative to the root: sums of coordinates far from the origin would round more.
    centroid.col(part.root) += points.col(i) - points.col(part.root);
    ++count[part.root];
  }
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const int root = part_of(i).root;
    if (!normals.col(i).allFinite()) continue;
    outwards[root] +=
        normals.col(i).dot(points.col(i) - points.col(root) - centroid.col(root) / count[root]);
  }
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    if (outwards[part_of(i).root] < 0) normals.col(i) *= -1;
  }
}

}  // namespace palpate::geometry
