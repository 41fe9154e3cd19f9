// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/snakes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "image/hue.h"
#include "regions/snake_contour.h"
#include "regions/variance_queue.h"

namespace palpate::sensing {
namespace {

/// Initial radius of the snakes [px]; narrower regions are not found.
constexpr long kRadius = 6;
static_assert(static_cast<double>(kRadius) > SnakeContour::kCriticalRadius);

/// The roughness is the phase variance divided by its limit, at most this: depth steps, borders of
/// the light and noise are not distinguished.
constexpr float kRoughest = 2;

/// Unreached pixels join a region within this distance [px].
constexpr int kAbsorbReach = 2;

/// Limit of the rounds per pixel of the image sides: a front crosses the image in fewer; slower
/// motion is creeping.
constexpr int kRoundsPerPixel = 20;

int rank_of(float roughness) {
  return std::min(static_cast<int>(std::sqrt(roughness) * VarianceQueue::kRanks),
                  VarianceQueue::kRanks - 1);
}

/// Centres of all squares of half-width kRadius that contain only smooth pixels, by mean roughness.
void queue_centers(const Plane& roughness, VarianceQueue& queue) {
  const long rows = roughness.rows();
  const long columns = roughness.cols();
  using Sums = Eigen::Array<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  Sums sums = Sums::Zero(rows + 1, columns + 1);
  Sums rough = sums;
  for (long row = 0; row < rows; ++row) {
    double sum = 0;
    double count = 0;
    for (long column = 0; column < columns; ++column) {
      sum += static_cast<double>(roughness(row, column));
      count += roughness(row, column) > 1 ? 1 : 0;
      sums(row + 1, column + 1) = sums(row, column + 1) + sum;
      rough(row + 1, column + 1) = rough(row, column + 1) + count;
    }
  }
  const auto within = [](const Sums& all, long row, long column) {
    const long bottom = row + kRadius + 1;
    const long right = column + kRadius + 1;
    const long top = row - kRadius;
    const long left = column - kRadius;
    return all(bottom, right) - all(top, right) - all(bottom, left) + all(top, left);
  };
  constexpr double kPixels = (2 * kRadius + 1) * (2 * kRadius + 1);
  for (long row = kRadius; row + kRadius < rows; ++row) {
    for (long column = kRadius; column + kRadius < columns; ++column) {
      if (within(rough, row, column) > 0) continue;
      const auto mean = static_cast<float>(within(sums, row, column) / kPixels);
      queue.push(static_cast<int>(row * columns + column), rank_of(std::max(mean, 0.0F)));
    }
  }
}

bool is_free(const Labels& labels, long row, long column) {
  return (labels.block(row - kRadius, column - kRadius, 2 * kRadius + 1, 2 * kRadius + 1) < 0)
      .all();
}

/// Labels the free pixels whose centres lie inside a polygon.
void fill(const Eigen::Matrix2Xd& polygon, int label, Labels& labels) {
  std::vector<std::vector<double>> crossings(static_cast<std::size_t>(labels.rows()));
  for (long i = 0; i < polygon.cols(); ++i) {
    Eigen::Vector2d a = polygon.col(i);
    Eigen::Vector2d b = polygon.col((i + 1) % polygon.cols());
    if (a.y() > b.y()) std::swap(a, b);
    const auto first = static_cast<long>(std::ceil(a.y()));
    for (long row = std::max(0L, first); row < labels.rows() && static_cast<double>(row) < b.y();
         ++row) {
      const double share = (static_cast<double>(row) - a.y()) / (b.y() - a.y());
      crossings[static_cast<std::size_t>(row)].push_back(a.x() + share * (b.x() - a.x()));
    }
  }
  for (long row = 0; row < labels.rows(); ++row) {
    auto& in_row = crossings[static_cast<std::size_t>(row)];
    std::sort(in_row.begin(), in_row.end());
    for (std::size_t i = 0; i + 1 < in_row.size(); i += 2) {
      const auto first = static_cast<long>(std::ceil(std::max(in_row[i], 0.0)));
      const auto last = std::min(static_cast<long>(std::floor(in_row[i + 1])), labels.cols() - 1);
      for (long column = first; column <= last; ++column) {
        if (labels(row, column) < 0) labels(row, column) = label;
      }
    }
  }
}

/// Lets free smooth pixels beside regions join them, from all sides simultaneously.
void absorb(const Plane& wrapped, const Plane& roughness, double max_step, Labels& labels) {
  for (int reached = 0; reached < kAbsorbReach; ++reached) {
    const Labels before = labels;
    for (long row = 0; row < labels.rows(); ++row) {
      for (long column = 0; column < labels.cols(); ++column) {
        if (before(row, column) >= 0 || !(roughness(row, column) <= 1)) continue;
        const auto join = [&](long r, long c) {
          if (r < 0 || c < 0 || r >= labels.rows() || c >= labels.cols()) return;
          if (before(r, c) < 0 || labels(row, column) >= 0) return;
          const float step = wrap(wrapped(r, c) - wrapped(row, column));
          if (static_cast<double>(std::abs(step)) <= max_step) labels(row, column) = before(r, c);
        };
        join(row, column - 1);
        join(row, column + 1);
        join(row - 1, column);
        join(row + 1, column);
      }
    }
  }
}

/// Unwraps the pixels of each label from its seed, the smoothest border pixel first. Pixels that
/// are not reached or not smooth lose their label.
void unwrap(const Plane& wrapped, const Plane& variance, const Plane& roughness,
            const std::vector<int>& seeds, Regions& regions) {
  const int columns = static_cast<int>(wrapped.cols());
  const int pixels = static_cast<int>(wrapped.size());
  int* label = regions.label.data();
  float* phase = regions.phase.data();
  Mask done = Mask::Zero(wrapped.rows(), wrapped.cols());
  VarianceQueue queue;
  for (const int seed : seeds) {
    done.data()[seed] = 1;
    queue.push(seed, 0);
    for (int pixel = queue.pop(); pixel >= 0; pixel = queue.pop()) {
      const auto visit = [&](int other) {
        if (label[other] != label[pixel] || done.data()[other] != 0) return;
        if (!std::isfinite(variance.data()[other])) return;
        done.data()[other] = 1;
        phase[other] = phase[pixel] + wrap(wrapped.data()[other] - wrapped.data()[pixel]);
        queue.push(other, rank_of(roughness.data()[other]));
      };
      const int column = pixel % columns;
      if (column > 0) visit(pixel - 1);
      if (column + 1 < columns) visit(pixel + 1);
      if (pixel >= columns) visit(pixel - columns);
      if (pixel + columns < pixels) visit(pixel + columns);
    }
    queue.reset();
  }
  for (int i = 0; i < pixels; ++i) {
    if (done.data()[i] == 0 || roughness.data()[i] > 1) label[i] = -1;
  }
}

}  // namespace

void grow_snakes(const Plane& wrapped, const Plane& variance, const FloodLimits& limits,
                 Regions& regions) {
  const auto limit = static_cast<float>(limits.max_variance);
  const Plane roughness = variance.unaryExpr([limit](float value) {
    return value < kRoughest * limit ? value / limit : kRoughest;  // includes NaN
  });
  regions = {Labels::Constant(wrapped.rows(), wrapped.cols(), -1), wrapped, 0};
  VarianceQueue centers;
  queue_centers(roughness, centers);
  const int max_rounds = kRoundsPerPixel * static_cast<int>(wrapped.rows() + wrapped.cols());
  std::vector<int> seeds;
  for (int center = centers.pop(); center >= 0; center = centers.pop()) {
    const long row = center / wrapped.cols();
    const long column = center % wrapped.cols();
    if (!is_free(regions.label, row, column)) continue;
    SnakeContour contour({static_cast<double>(column), static_cast<double>(row)}, kRadius,
                         roughness, regions.label);
    contour.grow(max_rounds);
    fill(contour.points(), regions.count, regions.label);
    // Label the centre even if the contour has left it, so that the next circle starts elsewhere.
    regions.label(row, column) = regions.count++;
    seeds.push_back(center);
  }
  absorb(wrapped, roughness, limits.max_step, regions.label);
  unwrap(wrapped, variance, roughness, seeds, regions);
}

}  // namespace palpate::sensing
