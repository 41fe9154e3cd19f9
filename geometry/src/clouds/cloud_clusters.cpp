// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/cloud_clusters.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <numeric>

#include "base/disjoint_sets.h"
#include "clouds/cell_numbers.h"
#include "clouds/known_points.h"
#include "palpate/core/require.h"
#include "palpate/core/work_steps.h"

namespace palpate::geometry {
namespace {

using PointsRef = Eigen::Ref<const Eigen::Matrix3Xd>;

/// Points by cell. All points of a cell are within `max_gap` of each other: its diagonal is a
/// little shorter.
struct FilledCells {
  CellNumbers numbers;
  std::vector<std::vector<int>> points;
};

FilledCells fill_cells(const PointsRef& points, double max_gap) {
  constexpr double kEdge = 0.577;  // < 1 / sqrt(3)
  const std::vector<int> known = known_points(points);
  FilledCells filled;
  if (known.empty()) return filled;
  Eigen::Vector3d origin = points.col(known.front());
  for (const int i : known) origin = origin.cwiseMin(points.col(i));
  for (const int i : known) {
    const auto cell = static_cast<std::size_t>(filled.numbers.number(
        cell_of(points.col(i), origin, kEdge * max_gap, "CloudClusterOptions::max_gap")));
    if (cell == filled.points.size()) filled.points.emplace_back();
    filled.points[cell].push_back(i);
  }
  return filled;
}

/// The cells after (0, 0, 0) in lexicographic order that may have points within reach.
std::vector<Cell> later_neighbours() {
  std::vector<Cell> offsets;
  for (std::int64_t x = 0; x <= 2; ++x)
    for (std::int64_t y = -2; y <= 2; ++y)
      for (std::int64_t z = -2; z <= 2; ++z)
        if (x > 0 || y > 0 || (y == 0 && z > 0)) offsets.emplace_back(x, y, z);
  // The nearest first: most cells join through them, and the others need not be compared.
  std::stable_sort(offsets.begin(), offsets.end(),
                   [](const Cell& a, const Cell& b) { return a.squaredNorm() < b.squaredNorm(); });
  return offsets;
}

Eigen::AlignedBox3d box_of(const PointsRef& points, const std::vector<int>& some) {
  Eigen::AlignedBox3d box;
  for (const int i : some) box.extend(points.col(i));
  return box;
}

/// Those of `some` that are within reach of a box.
std::vector<int> near_box(const PointsRef& points, const std::vector<int>& some,
                          const Eigen::AlignedBox3d& box, double reach) {
  std::vector<int> near;
  for (const int i : some) {
    if (box.squaredExteriorDistance(Eigen::Vector3d(points.col(i))) <= reach * reach)
      near.push_back(i);
  }
  return near;
}

bool have_pair(const PointsRef& points, const std::vector<int>& a, const std::vector<int>& b,
               double reach) {
  for (const int i : a) {
    for (const int j : b) {
      if ((points.col(i) - points.col(j)).squaredNorm() <= reach * reach) return true;
    }
  }
  return false;
}

bool have_pair_within(const PointsRef& points, const std::vector<int>& a, const std::vector<int>& b,
                      double reach) {
  // Of large cells, only the points that face each other are compared.
  constexpr std::size_t kFew = 256;  // pairs
  if (a.size() * b.size() > kFew) {
    const std::vector<int> near_b = near_box(points, a, box_of(points, b), reach);
    if (near_b.empty()) return false;
    const std::vector<int> near_a = near_box(points, b, box_of(points, near_b), reach);
    return have_pair(points, near_b, near_a, reach);
  }
  return have_pair(points, a, b, reach);
}

/// Joins cells one of whose points is within reach of one of the other's.
SignedSets joined_cells(const PointsRef& points, const FilledCells& filled, double max_gap,
                        const WorkSteps::Progress& progress) {
  struct Numbered {
    Cell cell;
    int number;
  };
  const auto comes_before = [](const Cell& a, const Cell& b) {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end());
  };
  std::vector<Numbered> sorted;
  for (const Cell& cell : filled.numbers.cells())
    sorted.push_back({cell, static_cast<int>(sorted.size())});
  std::sort(sorted.begin(), sorted.end(),
            [&](const Numbered& a, const Numbered& b) { return comes_before(a.cell, b.cell); });
  SignedSets sets(static_cast<int>(sorted.size()));
  const std::vector<Cell> offsets = later_neighbours();
  WorkSteps steps(progress, static_cast<int>(offsets.size()) + 1);
  for (const Cell& offset : offsets) {
    steps.tell();
    // The neighbours at one offset have the order of the cells: no search, and memory in a row.
    auto other = sorted.begin();
    for (const Numbered& each : sorted) {
      const Cell wanted = each.cell + offset;
      while (other != sorted.end() && comes_before(other->cell, wanted)) ++other;
      if (other == sorted.end()) break;
      if (other->cell != wanted ||
          sets.root_of(each.number).root == sets.root_of(other->number).root)
        continue;
      if (have_pair_within(points, filled.points[static_cast<std::size_t>(each.number)],
                           filled.points[static_cast<std::size_t>(other->number)], max_gap))
        sets.join(each.number, other->number);
    }
  }
  steps.end();
  return sets;
}

/// Ranks of the sets with at least `min_points` points by size; kNone for the others.
std::vector<int> ranks_of(const std::vector<int>& count, int min_points, std::vector<int>& sizes) {
  std::vector<int> order(count.size());
  std::iota(order.begin(), order.end(), 0);
  // Cells are numbered by their first point, and so are sets.
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return count[static_cast<std::size_t>(a)] > count[static_cast<std::size_t>(b)];
  });
  std::vector<int> rank(count.size(), kNone);
  for (const int set : order) {
    const int points = count[static_cast<std::size_t>(set)];
    if (points < min_points) break;
    rank[static_cast<std::size_t>(set)] = static_cast<int>(sizes.size());
    sizes.push_back(points);
  }
  return rank;
}

}  // namespace

void visit(CloudClusterOptions& options, FieldVisitor& visitor) {
  visitor.begin("CloudClusterOptions");
  visitor.real(
      {"max_gap", "Points at most this far apart are in one cluster", "mm", false, "cluster"},
      options.max_gap, above(0).finite());
  visitor.whole({"min_points", "Leave out clusters with fewer points"}, options.min_points,
                at_least(1));
}

CloudClusters cloud_clusters(const PointsRef& points, const CloudClusterOptions& options) {
  static_cast<void>(in_range(options));
  require_given("CloudClusterOptions::max_gap", options.max_gap.has_value());
  const FilledCells filled = fill_cells(points, *options.max_gap);
  SignedSets sets = joined_cells(points, filled, *options.max_gap, options.progress);
  std::vector<int> count(filled.points.size(), 0);
  for (std::size_t cell = 0; cell < filled.points.size(); ++cell) {
    count[static_cast<std::size_t>(sets.root_of(static_cast<int>(cell)).root)] +=
        static_cast<int>(filled.points[cell].size());
  }
  CloudClusters clusters{
      .cluster = std::vector<int>(static_cast<std::size_t>(points.cols()), kNone), .sizes = {}};
  const std::vector<int> rank = ranks_of(count, options.min_points, clusters.sizes);
  for (std::size_t cell = 0; cell < filled.points.size(); ++cell) {
    const int set = sets.root_of(static_cast<int>(cell)).root;
    for (const int i : filled.points[cell])
      clusters.cluster[static_cast<std::size_t>(i)] = rank[static_cast<std::size_t>(set)];
  }
  return clusters;
}

}  // namespace palpate::geometry
