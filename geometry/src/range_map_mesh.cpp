// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/range_map_mesh.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <string>

#include "palpate/error.h"

namespace palpate::geometry {
namespace {

constexpr int kUnused = -1;
// Rows of cells, and vertices, that one thread works on at a time.
constexpr Eigen::Index kRowsPerBand = 16;
constexpr Eigen::Index kGrain = 8192;

void check_options(const RangeMapMeshOptions& options) {
  if (!(options.max_depth_step > 0) || !std::isfinite(options.max_depth_step))
    throw InvalidInput("max_depth_step is " + std::to_string(options.max_depth_step) +
                       "; a fraction of the depth above 0 is needed, such as 0.01");
  if (!(options.max_incidence > 0 && options.max_incidence <= std::numbers::pi / 2))
    throw InvalidInput("max_incidence is " + std::to_string(options.max_incidence) +
                       "; an angle above 0 and up to pi/2 rad is needed");
}

/// Tells which neighbouring pixels lie on one surface.
///
/// It works on w = 1 / z, which is linear in the image where the surface is plane: what a surface
/// does beyond a pixel is then predicted from the two pixels before, however steep it is.
class DepthSteps {
 public:
  DepthSteps(const ImageF& z, double max_depth_step)
      : max_step_(max_depth_step),
        stride_(z.cols() + 2),
        inverse_depth_(static_cast<std::size_t>((z.rows() + 2) * stride_),
                       std::numeric_limits<double>::quiet_NaN()) {
    tbb::parallel_for(Eigen::Index{0}, z.rows(), [&](Eigen::Index row) {
      for (Eigen::Index col = 0; col < z.cols(); ++col) {
        const double depth = static_cast<double>(z(row, col));
        if (depth > 0 && std::isfinite(depth)) *at(row, col) = 1 / depth;
      }
    });
  }

  /// Whether the surface goes on from a pixel to the one on its right, or below it.
  [[nodiscard]] bool joined_right(Eigen::Index row, Eigen::Index col) const {
    return goes_on(at(row, col), 1, false);
  }
  [[nodiscard]] bool joined_below(Eigen::Index row, Eigen::Index col) const {
    return goes_on(at(row, col), stride_, false);
  }
  /// Whether it goes on to the pixel across the cell, given that it does so along two of its sides.
  [[nodiscard]] bool joined_falling(Eigen::Index row, Eigen::Index col) const {
    return goes_on(at(row, col), stride_ + 1, true);
  }
  [[nodiscard]] bool joined_rising(Eigen::Index row, Eigen::Index col) const {
    return goes_on(at(row, col + 1), stride_ - 1, true);
  }

 private:
  /// `unseen`: the answer for a step too large to be taken as it is if the surface is unknown both
  /// before and after it.
  [[nodiscard]] bool goes_on(const double* w, Eigen::Index next, bool unseen) const {
    const double step = w[next] - w[0];
    // |w - w'| <= s min(w, w') is |z - z'| <= s min(z, z').
    const double limit = max_step_ * std::min(w[0], w[next]);
    if (std::abs(step) <= limit) return true;
    // A steep surface comes at this slope and goes on at it. One side alone proves nothing: a pixel
    // that saw half of the one surface and half of the other lies between them. A side that is
    // unknown cannot object.
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
      inverse_depth_;  ///< with a frame of unknown pixels, so that all have neighbours
};

/// Whether a triangle faces the camera at an angle of at most acos(`min_cosine`) to its viewing
/// ray.
bool well_seen(const Eigen::Vector3d& a, const Eigen::Vector3d& b, const Eigen::Vector3d& c,
               double min_cosine) {
  const Eigen::Vector3d normal = (b - a).cross(c - a);
  const Eigen::Vector3d ray = a + b + c;
  const double towards = -normal.dot(ray);
  return towards > 0 && towards >= min_cosine * std::sqrt(normal.squaredNorm() * ray.squaredNorm());
}

/// Triangles of pixel numbers (row * cols + col).
using PixelTriangles = std::vector<Eigen::Vector3i>;

/// Joins the pixels of the rows from `first` to `last` into triangles.
PixelTriangles join_rows(const Eigen::Matrix3Xd& points, const DepthSteps& steps, double min_cosine,
                         Eigen::Index cols, Eigen::Index first, Eigen::Index last) {
  PixelTriangles triangles;
  triangles.reserve(static_cast<std::size_t>(2 * cols * (last - first)));
  const auto add = [&](int a, int b, int c) {
    if (well_seen(points.col(a), points.col(b), points.col(c), min_cosine))
      triangles.emplace_back(a, b, c);
  };
  for (Eigen::Index row = first; row < last; ++row) {
    bool left = steps.joined_below(row, 0);
    for (Eigen::Index col = 0; col + 1 < cols; ++col) {
      // a b
      // c d
      const int a = static_cast<int>(row * cols + col);
      const int b = a + 1;
      const int c = a + static_cast<int>(cols);
      const int d = c + 1;
      const bool right = steps.joined_below(row, col + 1);
      const bool top = steps.joined_right(row, col);
      const bool bottom = steps.joined_right(row + 1, col);
      const double falling =
          (points.col(a) - points.col(d)).squaredNorm();  // NaN if one is unknown
      const double rising = (points.col(b) - points.col(c)).squaredNorm();
      if (std::isnan(rising) || falling <= rising) {
        if (steps.joined_falling(row, col)) {
          if (left && bottom) add(a, c, d);
          if (top && right) add(a, d, b);
        }
      } else if (steps.joined_rising(row, col)) {
        if (left && top) add(a, c, b);
        if (bottom && right) add(b, c, d);
      }
      left = right;
    }
  }
  return triangles;
}

/// Joins the pixels of a map; each entry has the triangles of kRowsPerBand rows of cells.
std::vector<PixelTriangles> join_pixels(const RangeMap& map, const Eigen::Matrix3Xd& points,
                                        const RangeMapMeshOptions& options) {
  const DepthSteps steps(map.z, options.max_depth_step);
  const double min_cosine = std::cos(options.max_incidence);
  const Eigen::Index rows_of_cells = map.z.rows() - 1;
  const Eigen::Index bands = (rows_of_cells + kRowsPerBand - 1) / kRowsPerBand;
  std::vector<PixelTriangles> triangles(static_cast<std::size_t>(bands));
  tbb::parallel_for(Eigen::Index{0}, bands, [&](Eigen::Index band) {
    const Eigen::Index first = band * kRowsPerBand;
    triangles[static_cast<std::size_t>(band)] =
        join_rows(points, steps, min_cosine, map.z.cols(), first,
                  std::min(first + kRowsPerBand, rows_of_cells));
  });
  return triangles;
}

/// Numbers the pixels that have a triangle, in ascending order; the others get kUnused.
std::vector<int> number_vertices(const std::vector<PixelTriangles>& bands, std::size_t pixels) {
  std::vector<int> vertex(pixels, kUnused);
  tbb::parallel_for(std::size_t{0}, bands.size(), [&](std::size_t band) {
    for (const Eigen::Vector3i& triangle : bands[band]) {
      for (const int pixel : triangle) {
        // Atomic, because neighbouring bands share a row of pixels.
        std::atomic_ref(vertex[static_cast<std::size_t>(pixel)])
            .store(0, std::memory_order_relaxed);
      }
    }
  });
  int count = 0;
  for (int& number : vertex) {
    if (number != kUnused) number = count++;
  }
  return vertex;
}

}  // namespace

RangeMapMesh mesh_range_map(const RangeMap& map, const RangeMapMeshOptions& options) {
  check_options(options);
  const Eigen::Matrix3Xd points = back_project(map);
  const std::vector<PixelTriangles> bands = join_pixels(map, points, options);
  const std::vector<int> vertex = number_vertices(bands, static_cast<std::size_t>(map.z.size()));

  RangeMapMesh result;
  result.width = map.camera.width;
  result.height = map.camera.height;
  for (std::size_t pixel = 0; pixel < vertex.size(); ++pixel) {
    if (vertex[pixel] != kUnused) result.pixel.push_back(static_cast<int>(pixel));
  }
  result.mesh.vertices.resize(3, static_cast<Eigen::Index>(result.pixel.size()));
  tbb::parallel_for(tbb::blocked_range<Eigen::Index>(0, result.mesh.vertices.cols(), kGrain),
                    [&](const auto& range) {
                      for (Eigen::Index i = range.begin(); i < range.end(); ++i)
                        result.mesh.vertices.col(i) =
                            points.col(result.pixel[static_cast<std::size_t>(i)]);
                    });

  std::vector<Eigen::Index> first(bands.size() + 1, 0);
  for (std::size_t band = 0; band < bands.size(); ++band)
    first[band + 1] = first[band] + static_cast<Eigen::Index>(bands[band].size());
  result.mesh.triangles.resize(3, first.back());
  tbb::parallel_for(std::size_t{0}, bands.size(), [&](std::size_t band) {
    Eigen::Index t = first[band];
    for (const Eigen::Vector3i& triangle : bands[band]) {
      for (int corner = 0; corner < 3; ++corner)
        result.mesh.triangles(corner, t) = vertex[static_cast<std::size_t>(triangle[corner])];
      ++t;
    }
  });
  return result;
}

}  // namespace palpate::geometry
