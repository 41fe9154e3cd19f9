// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "mesh/compact_mesh.h"
#include "mesh/edge_table.h"
#include "mesh/triangle_primitives.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/require.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/surface_query.h"
#include "query/distance_bound.h"
#include "query/local_frame.h"

namespace palpate::geometry {
namespace {

/// Outward direction. At an edge or a vertex the normal of a single triangle may give the wrong
/// sign; correct are the sum of both normals and the angle-weighted mean, respectively (Baerentzen
/// and Aanaes 2005).
struct Sides {
  Eigen::Matrix3Xd of_triangles;
  Eigen::Matrix3Xd of_vertices;
  Eigen::Matrix3Xi triangles;
  Eigen::Matrix3Xi neighbours;

  explicit Sides(const TriangleMesh& mesh)
      : of_triangles(triangle_normals(mesh)),
        of_vertices(vertex_normals(mesh)),
        triangles(mesh.triangles),
        neighbours(triangle_neighbours(mesh.triangles)) {}

  [[nodiscard]] Eigen::Vector3d normal(const SurfacePoint& at) const {
    Eigen::Vector3d own = of_triangles.col(at.triangle);
    for (int k = 0; k < 3; ++k) {
      if (at.barycentric[k] == 1) return of_vertices.col(triangles(k, at.triangle));
    }
    for (int k = 0; k < 3; ++k) {
      const int across = at.barycentric[(k + 2) % 3] == 0 ? neighbours(k, at.triangle) : -1;
      if (across < 0) continue;
      Eigen::Vector3d other = of_triangles.col(across);
      // A triangle without area has no normal.
      if (!own.allFinite()) return other;
      if (other.allFinite()) return own + other;
    }
    return own;
  }
};

/// Finds the border of a surface.
class Border {
 public:
  explicit Border(const TriangleMesh& surface)
      : triangles_(surface.triangles),
        neighbours_(triangle_neighbours(surface.triangles)),
        vertices_(static_cast<std::size_t>(surface.vertices.cols()), false) {
    for (Eigen::Index t = 0; t < triangles_.cols(); ++t) {
      for (int k = 0; k < 3; ++k) {
        if (neighbours_(k, t) >= 0) continue;
        vertices_[static_cast<std::size_t>(triangles_(k, t))] = true;
        vertices_[static_cast<std::size_t>(triangles_((k + 1) % 3, t))] = true;
      }
    }
  }

  /// The nearest point of a point beyond the border is exactly on the border, except for rounding.
  [[nodiscard]] bool contains(const SurfacePoint& point) const {
    for (int k = 0; k < 3; ++k) {
      const bool at_vertex = point.barycentric[k] >= 1 - kBarycentricTolerance;
      if (at_vertex && vertices_[static_cast<std::size_t>(triangles_(k, point.triangle))])
        return true;
      const bool on_edge = point.barycentric[(k + 2) % 3] <= kBarycentricTolerance;
      if (on_edge && neighbours_(k, point.triangle) < 0) return true;
    }
    return false;
  }

 private:
  const Eigen::Matrix3Xi& triangles_;
  Eigen::Matrix3Xi neighbours_;
  std::vector<bool> vertices_;
};

/// Two meshes without the vertices that no triangle uses, moved to where the corners of pieces of
/// their triangles are rounded least. The move itself does not round.
struct MovedMeshes {
  TriangleMesh a, b;
  Eigen::Vector3d offset;  ///< moved = original - offset

  MovedMeshes(const TriangleMesh& of_a, const TriangleMesh& of_b)
      : a(compact(of_a).mesh),
        b(compact(of_b).mesh),
        offset(exact_offset(bounding_box(a).merged(bounding_box(b)))) {
    a.vertices.colwise() -= offset;
    b.vertices.colwise() -= offset;
  }

  /// Bounds of the distance between them, as original.
  [[nodiscard]] LargestDistance largest_distance(const TriangleMesh& from, const TriangleMesh& to,
                                                 const HausdorffOptions& options) const {
    LargestDistance largest =
        bound_largest_distance(from, DistanceTarget(to), {.max_gap = options.max_gap});
    largest.at += offset;
    return largest;
  }
};

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

Eigen::VectorXd distances_to_surface(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                     const TriangleMesh& surface) {
  const SurfaceQuery query(surface);
  const Sides sides(surface);
  Eigen::VectorXd distances(points.cols());
  parallel_for(points.cols(), [&](Eigen::Index i) {
    const ClosestPoint closest = query.closest_point(points.col(i));
    const bool behind = closest.at.triangle >= 0 &&
                        sides.normal(closest.at).dot(points.col(i) - closest.position) < 0;
    distances(i) = behind ? -closest.distance : closest.distance;
  });
  return distances;
}

Eigen::VectorXd distances_in_both(const Eigen::Ref<const Eigen::Matrix3Xd>& points,
                                  const TriangleMesh& surface, double max_distance) {
  require("distances_in_both(): max_distance", max_distance, above(0), "mm");
  const SurfaceQuery query(surface);
  const Border border(surface);
  Eigen::VectorXd distances(points.cols());
  parallel_for(points.cols(), [&](Eigen::Index i) {
    const ClosestPoint closest = query.closest_point(points.col(i));
    const bool is_common = closest.at.triangle >= 0 && closest.distance <= max_distance &&
                           !border.contains(closest.at);
    distances(i) = is_common ? closest.distance : std::numeric_limits<double>::quiet_NaN();
  });
  return distances;
}

LargestDistance one_sided_hausdorff_distance(const TriangleMesh& from, const TriangleMesh& to,
                                             const HausdorffOptions& options) {
  require("HausdorffOptions::max_gap", options.max_gap, above(0).at_most(1));
  check_mesh(from, "one_sided_hausdorff_distance(): from");
  check_mesh(to, "one_sided_hausdorff_distance(): to");
  const MovedMeshes moved(from, to);
  return moved.largest_distance(moved.a, moved.b, options);
}

HausdorffDistance hausdorff_distance(const TriangleMesh& a, const TriangleMesh& b,
                                     const HausdorffOptions& options) {
  require("HausdorffOptions::max_gap", options.max_gap, above(0).at_most(1));
  check_mesh(a, "hausdorff_distance(): a");
  check_mesh(b, "hausdorff_distance(): b");
  const MovedMeshes moved(a, b);
  HausdorffDistance distance;
  distance.a_to_b = moved.largest_distance(moved.a, moved.b, options);
  distance.b_to_a = moved.largest_distance(moved.b, moved.a, options);
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
