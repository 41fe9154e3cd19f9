// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "mesh/triangle_primitives.h"
#include "palpate/error.h"
#include "palpate/geometry/range_map_score.h"
#include "palpate/require.h"
#include "query/distance_bound.h"

namespace palpate::geometry {
namespace {

/// Upper limit of the cells: each has three points and a place in the result, so more would exhaust
/// the memory.
constexpr int kMaxCells = 100'000'000;

/// Number of parts of each triangle's sides that gives about `cells` cells of equal area.
std::vector<Eigen::Index> divisions(const Eigen::VectorXd& areas, double total, int cells) {
  std::vector<Eigen::Index> n;
  n.reserve(static_cast<std::size_t>(areas.size()));
  for (const double area : areas) {
    n.push_back(std::max<Eigen::Index>(1, std::lround(std::sqrt(cells * (area / total)))));
  }
  return n;
}

/// `mesh` with each side of triangle t cut in n[t] parts.
TriangleMesh cut_evenly(const TriangleMesh& mesh, const std::vector<Eigen::Index>& n) {
  Eigen::Index vertex_count = mesh.vertices.cols();
  Eigen::Index cell_count = 0;
  for (const Eigen::Index of_side : n) {
    vertex_count += (of_side + 1) * (of_side + 2) / 2 - 3;
    cell_count += of_side * of_side;
  }
  TriangleMesh cells;
  cells.vertices.resize(3, vertex_count);
  cells.vertices.leftCols(mesh.vertices.cols()) = mesh.vertices;
  cells.triangles.resize(3, cell_count);
  Eigen::Index next_vertex = mesh.vertices.cols();
  Eigen::Index next_cell = 0;
  std::vector<int> index;  // row by row, from corner 0 to the side opposite to it
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Index side = n[static_cast<std::size_t>(t)];
    const Eigen::Vector3i corners = mesh.triangles.col(t);
    const Eigen::Vector3d origin = mesh.vertices.col(corners[0]);
    const Eigen::Vector3d to_1 = mesh.vertices.col(corners[1]) - origin;
    const Eigen::Vector3d to_2 = mesh.vertices.col(corners[2]) - origin;
    index.clear();
    for (Eigen::Index row = 0; row <= side; ++row) {
      for (Eigen::Index i = 0; i <= row; ++i) {
        if (row == 0) {
          index.push_back(corners[0]);
        } else if (row == side && i == 0) {
          index.push_back(corners[1]);
        } else if (row == side && i == side) {
          index.push_back(corners[2]);
        } else {
          cells.vertices.col(next_vertex) =
              origin + (static_cast<double>(row - i) / static_cast<double>(side)) * to_1 +
              static_cast<double>(i) / static_cast<double>(side) * to_2;
          index.push_back(static_cast<int>(next_vertex++));
        }
      }
    }
    const auto at = [&index](Eigen::Index row, Eigen::Index i) {
      return index[static_cast<std::size_t>(row * (row + 1) / 2 + i)];
    };
    for (Eigen::Index row = 0; row < side; ++row) {
      for (Eigen::Index i = 0; i <= row; ++i) {
        cells.triangles.col(next_cell++) << at(row, i), at(row + 1, i), at(row + 1, i + 1);
        if (i < row) {
          cells.triangles.col(next_cell++) << at(row, i), at(row + 1, i + 1), at(row, i + 1);
        }
      }
    }
  }
  return cells;
}

constexpr int kPoints = 3;  ///< quadrature points per cell

/// Three points per cell, at barycentric (2/3, 1/6, 1/6) and its permutations: exact for quadratic
/// functions (Strang and Fix 1973).
Eigen::Matrix3Xd quadrature_points(const TriangleMesh& cells) {
  Eigen::Matrix3Xd points(3, kPoints * cells.triangles.cols());
  for (Eigen::Index c = 0; c < cells.triangles.cols(); ++c) {
    for (int k = 0; k < kPoints; ++k) {
      SurfacePoint point{.triangle = static_cast<int>(c),
                         .barycentric = Eigen::Vector3d::Constant(1.0 / 6)};
      point.barycentric[k] = 2.0 / 3;
      points.col(kPoints * c + k) = position(cells, point);
    }
  }
  return points;
}

/// The value below which a fraction of the weight lies.
double weighted_quantile(const std::vector<std::pair<double, double>>& sorted, double fraction) {
  double total = 0;
  for (const auto& [value, weight] : sorted) total += weight;
  double sum = 0;
  for (const auto& [value, weight] : sorted) {
    sum += weight;
    if (sum >= fraction * total) return value;
  }
  return sorted.back().first;
}

}  // namespace

LargestDistance one_sided_hausdorff_distance(const TriangleMesh& from, const TriangleMesh& to,
                                             const HausdorffOptions& options) {
  require("HausdorffOptions::max_gap", options.max_gap, above(0).at_most(1));
  check_mesh(from, "one_sided_hausdorff_distance(): from");
  check_mesh(to, "one_sided_hausdorff_distance(): to");
  return bound_largest_distance(from, DistanceTarget(to), {.max_gap = options.max_gap});
}

HausdorffDistance hausdorff_distance(const TriangleMesh& a, const TriangleMesh& b,
                                     const HausdorffOptions& options) {
  require("HausdorffOptions::max_gap", options.max_gap, above(0).at_most(1));
  check_mesh(a, "hausdorff_distance(): a");
  check_mesh(b, "hausdorff_distance(): b");
  const BoundGoal goal{.max_gap = options.max_gap};
  HausdorffDistance distance;
  distance.a_to_b = bound_largest_distance(a, DistanceTarget(b), goal);
  distance.b_to_a = bound_largest_distance(b, DistanceTarget(a), goal);
  distance.lower = std::max(distance.a_to_b.lower, distance.b_to_a.lower);
  distance.upper = std::max(distance.a_to_b.upper, distance.b_to_a.upper);
  return distance;
}

SurfaceDistances surface_distances(const TriangleMesh& from, const TriangleMesh& to,
                                   const SurfaceDistanceOptions& options) {
  require("SurfaceDistanceOptions::cells", options.cells, at_least(1).at_most(kMaxCells));
  check_mesh(from, "surface_distances(): from");
  check_mesh(to, "surface_distances(): to");
  Eigen::VectorXd areas(from.triangles.cols());
  for (Eigen::Index t = 0; t < areas.size(); ++t) {
    areas[t] = area_vector(from.vertices, from.triangles.col(t)).norm();
  }
  SurfaceDistances result;
  result.area = areas.sum();
  if (!(result.area > 0)) throw InvalidInput("surface_distances(): from: the mesh has no area");
  if (!std::isfinite(result.area)) {
    throw InvalidInput(
        "surface_distances(): from: the mesh is so large that its area overflows; is it in mm?");
  }
  const std::vector<Eigen::Index> n = divisions(areas, result.area, options.cells);
  result.cells = cut_evenly(from, n);
  const Eigen::VectorXd at_point = distances_to_surface(quadrature_points(result.cells), to);

  result.distance.resize(result.cells.triangles.cols());
  std::vector<std::pair<double, double>> weighted;  // absolute distance, area
  weighted.reserve(static_cast<std::size_t>(at_point.size()));
  double sum = 0;
  double sum_of_squares = 0;
  Eigen::Index cell = 0;
  for (Eigen::Index t = 0; t < areas.size(); ++t) {
    const Eigen::Index side = n[static_cast<std::size_t>(t)];
    const double of_cell = areas[t] / static_cast<double>(side * side);
    for (const Eigen::Index end = cell + side * side; cell < end; ++cell) {
      const Eigen::Vector3d d = at_point.segment<kPoints>(kPoints * cell);
      result.distance[cell] = d.mean();
      sum += of_cell * d.mean();
      sum_of_squares += of_cell * d.squaredNorm() / kPoints;
      for (const double one : d) weighted.emplace_back(std::abs(one), of_cell / kPoints);
    }
  }
  if (!std::isfinite(sum_of_squares)) {
    throw InvalidInput(
        "surface_distances(): the surfaces lie so far apart that distances overflow; are both in "
        "mm?");
  }
  std::sort(weighted.begin(), weighted.end());
  result.mean = sum / result.area;
  result.rms = std::sqrt(sum_of_squares / result.area);
  result.median = weighted_quantile(weighted, 0.5);
  result.p90 = weighted_quantile(weighted, 0.9);
  return result;
}

}  // namespace palpate::geometry
