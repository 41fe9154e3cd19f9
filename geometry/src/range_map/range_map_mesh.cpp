// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numbers>
#include <numeric>

#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"

namespace palpate::geometry {
namespace {

/// Decides which neighbouring pixels lie on one surface.
///
/// Uses w = 1 / z, which is linear in the image where the surface is plane, so that the two pixels
/// before predict the surface beyond a pixel, however steep it is.
class DepthSteps {
 public:
  DepthSteps(const ImageF& z, double max_depth_step)
      : max_step_(max_depth_step),
        stride_(z.cols() + 2),
        inverse_depth_(static_cast<std::size_t>((z.rows() + 2) * stride_),
                       std::numeric_limits<double>::quiet_NaN()) {
    parallel_for(z.rows(), [&](Eigen::Index row) {
      for (Eigen::Index col = 0; col < z.cols(); ++col) {
        const double depth = static_cast<double>(z(row, col));
        if (depth > 0 && std::isfinite(depth)) *at(row, col) = 1 / depth;
      }
    });
  }

  /// Returns true if the surface continues from a pixel to the one on its right, or below it.
  [[nodiscard]] bool joined_right(Eigen::Index row, Eigen::Index col) const {
    return goes_on(at(row, col), 1, false);
  }
  [[nodiscard]] bool joined_below(Eigen::Index row, Eigen::Index col) const {
    return goes_on(at(row, col), stride_, false);
  }
  /// Returns true if it continues to the pixel across the cell, given that it does along two sides.
  [[nodiscard]] bool joined_falling(Eigen::Index row, Eigen::Index col) const {
    return goes_on(at(row, col), stride_ + 1, true);
  }
  [[nodiscard]] bool joined_rising(Eigen::Index row, Eigen::Index col) const {
    return goes_on(at(row, col + 1), stride_ - 1, true);
  }

 private:
  /// `unseen`: the answer for a large step if the surface is unknown both before and after it.
  [[nodiscard]] bool goes_on(const double* w, Eigen::Index next, bool unseen) const {
    const double step = w[next] - w[0];
    // |w - w'| <= s min(w, w') is equivalent to |z - z'| <= s min(z, z').
    const double limit = max_step_ * std::min(w[0], w[next]);
    if (std::abs(step) <= limit) return true;
    // A steep surface has this slope before and after the step. One side alone is no proof, because
    // a pixel that sees half of two surfaces lies between them. An unknown side does not object.
    const double bend_before = std::abs(step - (w[0] - w[-next]));
    const double bend_after = std::abs(step - (w[2 * next] - w[next]));
    if (std::isnan(bend_before) && std::isnan(bend_after)) return unseen && !std::isnan(step);
    return !(bend_before > limit) && !(bend_after > limit);
  }

  double* at(Eigen::Index row, Eigen::Index col) {
    return inverse_depth_.data() + (row + 1) * stride_ + col + 1;
  }
  [[nodiscard]] const double* at(Eigen::Index row, Eigen::Index col) const {
    return inverse_depth_.data() + (row + 1) * stride_ + col + 1;
  }

  double max_step_;
  Eigen::Index stride_;
  std::vector<double>
      inverse_depth_;  ///< padded with unknown pixels, so that all pixels have neighbours
};

/// Returns true if a triangle faces the camera at an angle of at most acos(`min_cosine`) to its
/// viewing ray.
bool well_seen(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
               double min_cosine) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const Eigen::Vector3d ray = a + b + c;
  const double towards = -normal.dot(ray);
  return towards > 0 && towards >= min_cosine * std::sqrt(normal.squaredNorm() * ray.squaredNorm());
}

/// The triangles of a cell of four pixels, as bits:
///
///     a b     falling diagonal (a d): first (a c d), second (a d b)
///     c d     rising diagonal (b c):  first (a c b), second (b c d)
using Cell = std::uint8_t;
constexpr Cell kFirstTriangle = 1;
constexpr Cell kSecondTriangle = 2;
constexpr Cell kRising = 4;

/// The corners of a cell by number: a b c d.
using CellTriangle = std::array<int, 3>;
constexpr std::array<std::array<CellTriangle, 2>, 2> kTriangles = {
    {{{{0, 2, 3}, {0, 3, 1}}}, {{{0, 2, 1}, {1, 2, 3}}}}};  // [rising][second]

/// Calls `visit` with the corners of each triangle of a cell.
template <typename Visit>
void for_each_triangle(Cell cell, const Visit& visit) {
  const auto& [first, second] = kTriangles[(cell & kRising) != 0 ? 1 : 0];
  if ((cell & kFirstTriangle) != 0) visit(first);
  if ((cell & kSecondTriangle) != 0) visit(second);
}

/// The corners of each cell that are in a triangle, corner k as bit k.
constexpr std::array<unsigned, 8> kUsedCorners = {0, 0b1101, 0b1011, 0b1111,
                                                  0, 0b0111, 0b1110, 0b1111};

bool has_corner(Cell cell, unsigned corner) { return (kUsedCorners[cell] >> corner & 1U) != 0; }

/// The cell with pixel (row, col) as its corner d; padded with empty cells, so that every pixel has
/// four cells.
using Cells = Eigen::Array<Cell, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// The triangles of one row of cells.
void join_row(const Eigen::Matrix3Xd& points, const DepthSteps& steps, double min_cosine,
              Eigen::Index row, Cells& cells) {
  const Eigen::Index width = cells.cols() - 1;
  bool left = steps.joined_below(row, 0);
  for (Eigen::Index col = 0; col + 1 < width; ++col) {
    const Eigen::Index a = row * width + col;
    const std::array<Eigen::Index, 4> pixel = {a, a + 1, a + width, a + width + 1};
    const auto point = [&](int corner) {
      return points.col(pixel[static_cast<std::size_t>(corner)]);
    };
    const auto seen = [&](const CellTriangle& corners) {
      return well_seen(point(corners[0]), point(corners[1]), point(corners[2]), min_cosine);
    };
    const bool right = steps.joined_below(row, col + 1);
    const bool top = steps.joined_right(row, col);
    const bool bottom = steps.joined_right(row + 1, col);
    const double falling = (point(0) - point(3)).squaredNorm();  // NaN if one is unknown
    const double rising = (point(1) - point(2)).squaredNorm();
    Cell cell = 0;
    if (std::isnan(rising) || falling <= rising) {
      if (steps.joined_falling(row, col)) {
        if (left && bottom && seen(kTriangles[0][0])) cell |= kFirstTriangle;
        if (top && right && seen(kTriangles[0][1])) cell |= kSecondTriangle;
      }
    } else if (steps.joined_rising(row, col)) {
      cell = kRising;
      if (left && top && seen(kTriangles[1][0])) cell |= kFirstTriangle;
      if (bottom && right && seen(kTriangles[1][1])) cell |= kSecondTriangle;
    }
    cells(row + 1, col + 1) = cell;
    left = right;
  }
}

Cells join_pixels(const RangeMap& map, const Eigen::Matrix3Xd& points,
                  const RangeMapMeshOptions& options) {
  const DepthSteps steps(map.z, options.max_depth_step);
  const double min_cosine = std::cos(options.max_incidence);
  Cells cells = Cells::Zero(map.z.rows() + 1, map.z.cols() + 1);
  parallel_for(map.z.rows() - 1,
               [&](Eigen::Index row) { join_row(points, steps, min_cosine, row, cells); });
  return cells;
}

/// Returns true if a pixel is a corner of a triangle of one of the cells around it.
bool is_used(const Cells& cells, Eigen::Index row, Eigen::Index col) {
  return has_corner(cells(row + 1, col + 1), 0) || has_corner(cells(row + 1, col), 1) ||
         has_corner(cells(row, col + 1), 2) || has_corner(cells(row, col), 3);
}

/// Start index of each row if `count(row)` items per row are stored one row after another, followed
/// by the total.
template <typename Count>
std::vector<Eigen::Index> row_starts(Eigen::Index rows, const Count& count) {
  std::vector<Eigen::Index> starts(static_cast<std::size_t>(rows + 1), 0);
  parallel_for(rows,
               [&](Eigen::Index row) { starts[static_cast<std::size_t>(row + 1)] = count(row); });
  std::partial_sum(starts.begin(), starts.end(), starts.begin());
  return starts;
}

/// Numbers the pixels that have a triangle, row by row: fills in pixel and point of each vertex,
/// and returns the vertex of each such pixel.
std::vector<int> take_vertices(const Cells& cells, const Eigen::Matrix3Xd& points,
                               RangeMapMesh& result) {
  constexpr int kUnused = -1;
  const Eigen::Index width = cells.cols() - 1;
  std::vector<int> vertex(static_cast<std::size_t>(points.cols()), kUnused);
  const auto starts = row_starts(cells.rows() - 1, [&](Eigen::Index row) {
    Eigen::Index count = 0;
    for (Eigen::Index col = 0; col < width; ++col) {
      if (!is_used(cells, row, col)) continue;
      vertex[static_cast<std::size_t>(row * width + col)] = static_cast<int>(count);
      ++count;
    }
    return count;
  });
  result.source.resize(static_cast<std::size_t>(starts.back()));
  result.mesh.vertices.resize(3, starts.back());
  parallel_for(cells.rows() - 1, [&](Eigen::Index row) {
    const auto start = static_cast<int>(starts[static_cast<std::size_t>(row)]);
    for (Eigen::Index pixel = row * width; pixel < (row + 1) * width; ++pixel) {
      int& number = vertex[static_cast<std::size_t>(pixel)];
      if (number == kUnused) continue;
      number += start;
      result.source[static_cast<std::size_t>(number)] = static_cast<int>(pixel);
      result.mesh.vertices.col(number) = points.col(pixel);
    }
  });
  return vertex;
}

void take_triangles(const Cells& cells, const std::vector<int>& vertex, RangeMapMesh& result) {
  const Eigen::Index width = cells.cols() - 1;
  const Eigen::Index rows_of_cells = cells.rows() - 2;
  const auto starts = row_starts(rows_of_cells, [&](Eigen::Index row) {
    Eigen::Index count = 0;
    for (const Cell cell : cells.row(row + 1))
      count += (cell & kFirstTriangle) + (cell & kSecondTriangle) / kSecondTriangle;
    return count;
  });
  result.mesh.triangles.resize(3, starts.back());
  parallel_for(rows_of_cells, [&](Eigen::Index row) {
    Eigen::Index triangle = starts[static_cast<std::size_t>(row)];
    for (Eigen::Index col = 0; col + 1 < width; ++col) {
      const auto a = static_cast<std::size_t>(row * width + col);
      const auto below = static_cast<std::size_t>(width);
      const std::array<int, 4> corner = {vertex[a], vertex[a + 1], vertex[a + below],
                                         vertex[a + below + 1]};
      for_each_triangle(cells(row + 1, col + 1), [&](const CellTriangle& corners) {
        for (int k = 0; k < 3; ++k)
          result.mesh.triangles(k, triangle) =
              corner[static_cast<std::size_t>(corners[static_cast<std::size_t>(k)])];
        ++triangle;
      });
    }
  });
}

}  // namespace

void visit(RangeMapMeshOptions& options, FieldVisitor& visitor) {
  visitor.begin("RangeMapMeshOptions");
  visitor.real({"max_depth_step",
                "Neighbouring pixels are on one surface if their depths differ by at most this "
                "share of the smaller one, or if they agree so well with the slopes on both sides",
                "of the depth"},
               options.max_depth_step, above(0).finite());
  constexpr bool kExpert = true;
  visitor.real(
      {"max_incidence", "Largest angle between the normal of a triangle and its viewing ray", "rad",
       kExpert},
      options.max_incidence, above(0).at_most(std::numbers::pi / 2));
}

RangeMapMesh mesh_range_map(const RangeMap& map, const RangeMapMeshOptions& options) {
  static_cast<void>(in_range(options));
  const Eigen::Matrix3Xd points = back_project(map);
  const Cells cells = join_pixels(map, points, options);
  RangeMapMesh result;
  result.width = map.camera.width;
  result.height = map.camera.height;
  const std::vector<int> vertex = take_vertices(cells, points, result);
  take_triangles(cells, vertex, result);
  return result;
}

}  // namespace palpate::geometry
