// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "cell_coloring.h"

#include <algorithm>
#include <set>
#include <utility>

namespace palpate::pictures {
namespace {

using Neighbours = std::vector<std::set<int>>;

Neighbours find_neighbours(const Eigen::Ref<const Eigen::Matrix3Xi>& triangles,
                           const Eigen::Ref<const Eigen::VectorXi>& labels, int count) {
  Neighbours neighbours(static_cast<std::size_t>(count));
  for (const auto& corners : triangles.colwise()) {
    for (int corner = 0; corner < 3; ++corner) {
      const int one = labels(corners(corner));
      const int other = labels(corners((corner + 1) % 3));
      if (one >= 0 && other >= 0 && one != other) {
        neighbours[static_cast<std::size_t>(one)].insert(other);
        neighbours[static_cast<std::size_t>(other)].insert(one);
      }
    }
  }
  return neighbours;
}

/// The cells so that each has few neighbours among those before it.
std::vector<int> smallest_last(const Neighbours& neighbours) {
  std::vector<std::size_t> degree;
  std::set<std::pair<std::size_t, int>> left;
  for (const std::set<int>& around : neighbours) {
    left.emplace(around.size(), static_cast<int>(degree.size()));
    degree.push_back(around.size());
  }
  std::vector<int> order;
  while (!left.empty()) {
    const int cell = left.begin()->second;
    left.erase(left.begin());
    order.push_back(cell);
    for (const int neighbour : neighbours[static_cast<std::size_t>(cell)]) {
      std::size_t& count = degree[static_cast<std::size_t>(neighbour)];
      if (left.erase({count, neighbour}) > 0) {
        left.emplace(--count, neighbour);
      }
    }
  }
  std::reverse(order.begin(), order.end());
  return order;
}

}  // namespace

std::vector<int> color_cells(const Eigen::Ref<const Eigen::Matrix3Xi>& triangles,
                             const Eigen::Ref<const Eigen::VectorXi>& labels, int count,
                             int palette) {
  const Neighbours neighbours = find_neighbours(triangles, labels, count);
  std::vector<int> colors(static_cast<std::size_t>(count), -1);
  std::vector<int> uses(static_cast<std::size_t>(palette), 0);
  for (const int cell : smallest_last(neighbours)) {
    // Rather than one of a neighbour take any other; of those the least used, so that all are about
    // as frequent.
    std::vector<std::pair<int, int>> costs;
    costs.reserve(uses.size());
    for (const int use : uses) {
      costs.emplace_back(0, use);
    }
    for (const int neighbour : neighbours[static_cast<std::size_t>(cell)]) {
      const int color = colors[static_cast<std::size_t>(neighbour)];
      if (color >= 0) {
        ++costs[static_cast<std::size_t>(color)].first;
      }
    }
    const auto best = std::min_element(costs.begin(), costs.end()) - costs.begin();
    ++uses[static_cast<std::size_t>(best)];
    colors[static_cast<std::size_t>(cell)] = static_cast<int>(best);
  }
  return colors;
}

}  // namespace palpate::pictures
