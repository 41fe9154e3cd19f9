// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/volume_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace palpate::geometry {
namespace {

/// Distances of neighbouring grid points differ by at most one spacing, and by little more where
/// scans disagree. A larger difference is that between the sides of two surfaces. [spacings]
constexpr double kLargestDifference = 2;
/// Newton's method on a nearly linear function.
constexpr int kNewtonSteps = 3;

/// Corner c of a cell is at (c & 1, c >> 1 & 1, c >> 2 & 1). An edge runs along `axis` from corner
/// `from`; its index is 4 axis + the two other bits of `from`.
struct CellEdge {
  int axis = 0, from = 0, to = 0;
};

constexpr int edge_index(int axis, int corner) {
  const int low = (corner >> (axis + 1) % 3) & 1, high = (corner >> (axis + 2) % 3) & 1;
  return 4 * axis + low + 2 * high;
}

constexpr std::array<CellEdge, 12> cell_edges() {
  std::array<CellEdge, 12> edges{};
  for (int axis = 0; axis < 3; ++axis) {
    for (int corner = 0; corner < 8; ++corner) {
      if ((corner >> axis & 1) == 0) {
        edges[static_cast<std::size_t>(edge_index(axis, corner))] = {
            .axis = axis, .from = corner, .to = corner | 1 << axis};
      }
    }
  }
  return edges;
}

constexpr std::array<CellEdge, 12> kEdges = cell_edges();

using CellDistances = std::array<double, 8>;
using CellPieces =
    std::array<std::int8_t, 12>;  ///< of each edge its piece; -1 if it is not crossed

bool inside(double distance) { return distance < 0; }

/// Assigns each crossed edge of a cell to a piece of the surface: those that a face connects are
/// one. A face with four crossed edges separates its inside corners, seen from both of its cells.
CellPieces pieces_in_cell(const CellDistances& d) {
  CellPieces piece;
  const auto crossed = [&](int e) {
    return inside(d[static_cast<std::size_t>(kEdges[static_cast<std::size_t>(e)].from)]) !=
           inside(d[static_cast<std::size_t>(kEdges[static_cast<std::size_t>(e)].to)]);
  };
  for (int e = 0; e < 12; ++e)
    piece[static_cast<std::size_t>(e)] = static_cast<std::int8_t>(crossed(e) ? e : -1);
  const auto join = [&](int a, int b) {
    const std::int8_t from = piece[static_cast<std::size_t>(a)];
    std::replace(piece.begin(), piece.end(), from, piece[static_cast<std::size_t>(b)]);
  };
  for (int axis = 0; axis < 3; ++axis) {
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    for (int side = 0; side < 2; ++side) {
      const int base = side << axis;
      // The corners in cyclic order; edge k runs from corner k to the next.
      const std::array<int, 4> corners = {base, base | 1 << b, base | 1 << b | 1 << c,
                                          base | 1 << c};
      const std::array<int, 4> edges = {edge_index(b, corners[0]), edge_index(c, corners[1]),
                                        edge_index(b, corners[3]), edge_index(c, corners[0])};
      const auto count = std::count_if(edges.begin(), edges.end(), crossed);
      if (count == 2) {
        const auto first = std::find_if(edges.begin(), edges.end(), crossed);
        join(*first, *std::find_if(first + 1, edges.end(), crossed));
      } else if (count == 4) {
        for (std::size_t k = 0; k < 4; ++k) {
          if (inside(d[static_cast<std::size_t>(corners[k])])) join(edges[k], edges[(k + 3) % 4]);
        }
      }
    }
  }
  return piece;
}

/// Trilinear interpolation of values at the corners of a cell.
double interpolate(const CellDistances& d, const Eigen::Vector3d& at) {
  double value = 0;
  for (std::size_t c = 0; c < 8; ++c) {
    value += d[c] * ((c & 1) != 0 ? at.x() : 1 - at.x()) * ((c & 2) != 0 ? at.y() : 1 - at.y()) *
             ((c & 4) != 0 ? at.z() : 1 - at.z());
  }
  return value;
}

Eigen::Vector3d gradient(const CellDistances& d, const Eigen::Vector3d& at) {
  Eigen::Vector3d slope;
  for (int axis = 0; axis < 3; ++axis) {
    Eigen::Vector3d low = at, high = at;
    low[axis] = 0;
    high[axis] = 1;
    slope[axis] = interpolate(d, high) - interpolate(d, low);
  }
  return slope;
}

/// Moves a point of a cell towards the zero, along the gradient, within the cell.
Eigen::Vector3d onto_zero(const CellDistances& d, Eigen::Vector3d at) {
  for (int step = 0; step < kNewtonSteps; ++step) {
    const Eigen::Vector3d slope = gradient(d, at);
    const double squared = slope.squaredNorm();
    if (squared == 0) break;
    at = (at - interpolate(d, at) / squared * slope).cwiseMax(0).cwiseMin(1);
  }
  return at;
}

class Contouring {
 public:
  Contouring(const Grid& grid, const std::vector<GridDistance>& points)
      : grid_(grid), points_(points) {
    for (int axis = 0; axis < 3; ++axis) find_neighbours(axis);
  }

  VolumeSurface run() {
    pieces_.resize(points_.size());
    for (std::size_t i = 0; i < points_.size(); ++i) add_vertices(i);
    for (std::size_t i = 0; i < points_.size(); ++i) {
      for (int axis = 0; axis < 3; ++axis) add_quadrilateral(i, axis);
    }
    VolumeSurface surface;
    const auto columns = [](const auto& list) { return static_cast<Eigen::Index>(list.size()); };
    surface.mesh.vertices.resize(3, columns(vertices_));
    for (std::size_t v = 0; v < vertices_.size(); ++v)
      surface.mesh.vertices.col(static_cast<Eigen::Index>(v)) = vertices_[v];
    surface.mesh.triangles.resize(3, columns(triangles_));
    for (std::size_t t = 0; t < triangles_.size(); ++t)
      surface.mesh.triangles.col(static_cast<Eigen::Index>(t)) = triangles_[t];
    surface.beyond = Eigen::Map<const Eigen::VectorXd>(beyond_.data(), columns(beyond_));
    surface.precision = Eigen::Map<const Eigen::VectorXd>(precision_.data(), columns(precision_));
    return surface;
  }

 private:
  /// The vertices of the cell above a grid point.
  struct Cell {
    int first = -1;  ///< the vertex of piece 0; -1 if the surface does not cross the cell
    CellPieces piece{};
  };

  void find_neighbours(int axis) {
    const std::int64_t step = grid_step(axis == 0, axis == 1, axis == 2);
    auto& next = next_[static_cast<std::size_t>(axis)];
    auto& previous = previous_[static_cast<std::size_t>(axis)];
    next.assign(points_.size(), -1);
    previous.assign(points_.size(), -1);
    std::size_t j = 0;
    for (std::size_t i = 0; i < points_.size(); ++i) {
      while (j < points_.size() && points_[j].key < points_[i].key + step) ++j;
      if (j == points_.size()) break;
      if (points_[j].key != points_[i].key + step) continue;
      next[i] = static_cast<int>(j);
      previous[j] = static_cast<int>(i);
    }
  }

  /// The corners of the cell above a grid point; an empty list if one is unknown.
  [[nodiscard]] std::array<int, 8> corners_of(std::size_t i) const {
    std::array<int, 8> corners{};
    corners[0] = static_cast<int>(i);
    for (std::size_t c = 1; c < 8; ++c) {
      const std::size_t axis = (c & 4) != 0 ? 2 : (c & 2) != 0 ? 1 : 0;
      const int before = corners[c & ~(std::size_t{1} << axis)];
      corners[c] = before < 0 ? -1 : next_[axis][static_cast<std::size_t>(before)];
    }
    return corners;
  }

  void add_vertices(std::size_t i) {
    const std::array<int, 8> corners = corners_of(i);
    if (std::find(corners.begin(), corners.end(), -1) != corners.end()) return;
    CellDistances d{}, beyond{}, precision{};
    for (std::size_t c = 0; c < 8; ++c) {
      const GridDistance& point = points_[static_cast<std::size_t>(corners[c])];
      d[c] = point.distance / grid_.spacing;
      beyond[c] = point.beyond;
      precision[c] = point.precision;
    }
    const auto [least, largest] = std::minmax_element(d.begin(), d.end());
    if (inside(*least) == inside(*largest)) return;
    for (const CellEdge& edge : kEdges) {
      if (std::abs(d[static_cast<std::size_t>(edge.from)] - d[static_cast<std::size_t>(edge.to)]) >
          kLargestDifference) {
        return;
      }
    }
    Cell& cell = pieces_[i];
    cell.first = static_cast<int>(vertices_.size());
    cell.piece = pieces_in_cell(d);
    number_pieces(cell.piece);
    const int count = *std::max_element(cell.piece.begin(), cell.piece.end()) + 1;
    for (int p = 0; p < count; ++p) {
      const Eigen::Vector3d at = onto_zero(d, middle_of_crossings(d, cell.piece, p));
      vertices_.push_back(grid_position(grid_, points_[i].key) + grid_.spacing * at);
      beyond_.push_back(interpolate(beyond, at));
      precision_.push_back(interpolate(precision, at));
    }
  }

  /// Renames the pieces 0, 1, ... in the order of their first edges.
  static void number_pieces(CellPieces& piece) {
    std::array<std::int8_t, 12> name;
    name.fill(-1);
    std::int8_t count = 0;
    for (std::int8_t& p : piece) {
      if (p < 0) continue;
      std::int8_t& number = name[static_cast<std::size_t>(p)];
      if (number < 0) number = count++;
      p = number;
    }
  }

  static Eigen::Vector3d middle_of_crossings(const CellDistances& d, const CellPieces& piece,
                                             int p) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (std::size_t e = 0; e < 12; ++e) {
      if (piece[e] != p) continue;
      const CellEdge& edge = kEdges[e];
      const double from = d[static_cast<std::size_t>(edge.from)];
      const double to = d[static_cast<std::size_t>(edge.to)];
      Eigen::Vector3d at(edge.from & 1, edge.from >> 1 & 1, edge.from >> 2);
      at[edge.axis] = from / (from - to);
      sum += at;
      ++count;
    }
    return sum / count;
  }

  /// The vertex that the cell above a grid point has at its edge; -1 if there is none.
  [[nodiscard]] int vertex_at(int i, int axis, int corner) const {
    if (i < 0) return -1;
    const Cell& cell = pieces_[static_cast<std::size_t>(i)];
    if (cell.first < 0) return -1;
    return cell.first + cell.piece[static_cast<std::size_t>(edge_index(axis, corner))];
  }

  /// Connects the four cells around the edge from a grid point along an axis, if it is crossed.
  void add_quadrilateral(std::size_t i, int axis) {
    const int end = next_[static_cast<std::size_t>(axis)][i];
    if (end < 0) return;
    const bool starts_inside = inside(points_[i].distance);
    if (starts_inside == inside(points_[static_cast<std::size_t>(end)].distance)) return;
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    const auto before = [&](int of, int along) {
      return of < 0 ? -1 : previous_[static_cast<std::size_t>(along)][static_cast<std::size_t>(of)];
    };
    const int here = static_cast<int>(i), left = before(here, b), below = before(here, c);
    std::array<int, 4> corners = {vertex_at(here, axis, 0), vertex_at(left, axis, 1 << b),
                                  vertex_at(before(left, c), axis, 1 << b | 1 << c),
                                  vertex_at(below, axis, 1 << c)};
    if (std::find(corners.begin(), corners.end(), -1) != corners.end()) return;
    if (!starts_inside) std::swap(corners[1], corners[3]);
    const auto length = [&](std::size_t p, std::size_t q) {
      return (vertices_[static_cast<std::size_t>(corners[p])] -
              vertices_[static_cast<std::size_t>(corners[q])])
          .squaredNorm();
    };
    const std::size_t first = length(0, 2) <= length(1, 3) ? 0 : 1;
    const auto corner = [&](std::size_t k) { return corners[(first + k) % 4]; };
    triangles_.emplace_back(corner(0), corner(1), corner(2));
    triangles_.emplace_back(corner(0), corner(2), corner(3));
  }

  Grid grid_;
  const std::vector<GridDistance>& points_;
  std::array<std::vector<int>, 3> next_,
      previous_;  ///< of each point along each axis, -1 if unknown
  std::vector<Cell> pieces_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<double> beyond_, precision_;
  std::vector<Eigen::Vector3i> triangles_;
};

}  // namespace

VolumeSurface zero_surface(const Grid& grid, const std::vector<GridDistance>& points) {
  return Contouring(grid, points).run();
}

}  // namespace palpate::geometry
