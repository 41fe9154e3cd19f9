// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "registration/surfel_grid.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "base/numbers.h"
#include "palpate/core/parallel_for.h"
#include "palpate/geometry/mesh_measures.h"

namespace palpate::geometry {
namespace {

/// Cells along the diagonal of the mesh.
constexpr int kCellsAlongDiagonal = 128;

/// The grid reaches this fraction of the diagonal beyond the mesh.
constexpr double kMargin = 0.1;

/// Large triangles are sampled once per cell, or more coarsely if this would take more than this
/// many samples.
constexpr double kMaxSamples = 4e6;

constexpr int kFar = std::numeric_limits<int>::max();

/// Accumulated surface in one cell.
struct CellSum {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  ///< times weight
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();    ///< times weight
  double weight = 0;
};

/// Number of samples along a triangle's first and last side.
Eigen::Array2i sample_counts(const Eigen::Vector3d& first, const Eigen::Vector3d& last,
                             double step) {
  return (Eigen::Array2d(first.norm(), last.norm()) / step).ceil().max(1).cast<int>();
}

}  // namespace

SurfelGrid::SurfelGrid(const TriangleMesh& mesh) {
  const Eigen::AlignedBox3d box = bounding_box(mesh);
  const double diagonal = box.diagonal().norm();
  cell_size_ = diagonal / kCellsAlongDiagonal;
  lower_ = box.min().array() - kMargin * diagonal;
  cells_ = ((box.max() - lower_).array() / cell_size_ + kMargin * kCellsAlongDiagonal)
               .ceil()
               .cast<int>();
  nearest_.assign(static_cast<size_t>(cells_.prod()), kNone);
  collect_surfels(mesh);
  std::vector<int> squared_distance(nearest_.size());
  std::transform(nearest_.begin(), nearest_.end(), squared_distance.begin(),
                 [](int surfel) { return surfel == kNone ? kFar : 0; });
  for (int axis = 0; axis < 3; ++axis) spread_along(axis, squared_distance);
}

void SurfelGrid::collect_surfels(const TriangleMesh& mesh) {
  const auto corner = [&](Eigen::Index t, int k) {
    return Eigen::Vector3d(mesh.vertices.col(mesh.triangles(k, t)));
  };
  double step = cell_size_;
  for (double samples = kInfinity; samples > kMaxSamples;) {
    if (std::isfinite(samples)) step *= 2;
    samples = -static_cast<double>(mesh.triangles.cols());  // a fine mesh needs one per triangle
    for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
      const Eigen::Vector3d origin = corner(t, 0);
      samples +=
          sample_counts(corner(t, 1) - origin, corner(t, 2) - origin, step).cast<double>().prod();
    }
  }
  std::vector<CellSum> sums;
  double area = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Vector3d origin = corner(t, 0);
    const Eigen::Vector3d first = corner(t, 1) - origin;
    const Eigen::Vector3d last = corner(t, 2) - origin;
    const Eigen::Vector3d normal = first.cross(last);  // its length is twice the area
    if (!(normal.norm() > 0)) continue;
    const Eigen::Array2i counts = sample_counts(first, last, step);
    // The parallelogram is sampled; samples beyond the diagonal are mirrored into the triangle.
    const double weight = normal.norm() / (2.0 * counts.prod());
    for (int i = 0; i < counts[0]; ++i) {
      for (int j = 0; j < counts[1]; ++j) {
        double a = (i + 0.5) / counts[0];
        double b = (j + 0.5) / counts[1];
        if (a + b > 1) {
          a = 1 - a;
          b = 1 - b;
        } else if (counts.prod() == 1) {
          a = b = 1.0 / 3;
        }
        const Eigen::Vector3d place = origin + a * first + b * last;
        const Eigen::Array3i cell = ((place - lower_) / cell_size_).array().cast<int>();
        int& surfel =
            nearest_[static_cast<size_t>((cell[2] * cells_[1] + cell[1]) * cells_[0] + cell[0])];
        if (surfel == kNone) {
          surfel = static_cast<int>(sums.size());
          sums.emplace_back();
        }
        CellSum& sum = sums[static_cast<size_t>(surfel)];
        sum.position += weight * place;
        // Two sheets in one cell must not cancel.
        sum.normal += (sum.normal.dot(normal) < 0 ? -weight : weight) * normal.normalized();
        sum.weight += weight;
        centroid_ += weight * place;
        area += weight;
      }
    }
  }
  centroid_ /= area;
  for (const CellSum& sum : sums) {
    surfels_.push_back({.position = (sum.position / sum.weight).cast<float>(),
                        .normal = sum.normal.normalized().cast<float>()});
  }
}

/// One pass of the distance transform: along each line of cells the lower envelope of parabolas.
void SurfelGrid::spread_along(int axis, std::vector<int>& squared_distance) {
  const std::array<int, 3> strides = {1, cells_[0], cells_[0] * cells_[1]};
  const int stride = strides[static_cast<size_t>(axis)];
  const int length = cells_[axis];
  const int other = axis == 0 ? 1 : 0;
  const int another = axis == 2 ? 1 : 2;
  parallel_for(cells_[another], [&](int outer) {
    std::vector<int> apex(static_cast<size_t>(length));  // places of the parabolas of the envelope
    std::vector<double> begin(static_cast<size_t>(length));  // from here on, each is the lowest
    std::vector<int> distance(static_cast<size_t>(length));
    std::vector<int> surfel(static_cast<size_t>(length));
    for (int inner = 0; inner < cells_[other]; ++inner) {
      const int line = outer * strides[static_cast<size_t>(another)] +
                       inner * strides[static_cast<size_t>(other)];
      int parabolas = 0;
      for (int i = 0; i < length; ++i) {
        const auto from = static_cast<size_t>(i);
        distance[from] = squared_distance[static_cast<size_t>(line + i * stride)];
        surfel[from] = nearest_[static_cast<size_t>(line + i * stride)];
        if (distance[from] == kFar) continue;
        double crossing = -kInfinity;
        while (parabolas > 0) {
          const int last = apex[static_cast<size_t>(parabolas - 1)];
          crossing = (static_cast<double>(distance[from]) + static_cast<double>(i) * i -
                      distance[static_cast<size_t>(last)] - static_cast<double>(last) * last) /
                     (2.0 * (i - last));
          if (crossing > begin[static_cast<size_t>(parabolas - 1)]) break;
          --parabolas;
          crossing = -kInfinity;
        }
        apex[static_cast<size_t>(parabolas)] = i;
        begin[static_cast<size_t>(parabolas)] = crossing;
        ++parabolas;
      }
      if (parabolas == 0) continue;
      for (int i = 0, lowest = 0; i < length; ++i) {
        while (lowest + 1 < parabolas && begin[static_cast<size_t>(lowest + 1)] < i) ++lowest;
        const int from = apex[static_cast<size_t>(lowest)];
        const auto to = static_cast<size_t>(line + i * stride);
        squared_distance[to] = distance[static_cast<size_t>(from)] + (i - from) * (i - from);
        nearest_[to] = surfel[static_cast<size_t>(from)];
      }
    }
  });
}

}  // namespace palpate::geometry
