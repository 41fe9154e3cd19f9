// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/rig_deviation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "image/hot_loop.h"
#include "palpate/core/error.h"
#include "setup/rig_jacobian.h"

namespace palpate::sensing {
namespace {

constexpr long kSpacing = 32;            ///< px between nodes
constexpr long kLevels = 17;             ///< of the inverse depth
constexpr double kLastLevel = 3;         ///< times the inverse depth in the middle: the last level
constexpr double kFirstLevel = 1.0 / 3;  ///< the first level

/// Fills the gaps of one ray with the nearest known level.
void fill_levels(float* levels) {
  for (long i = 1; i < kLevels; ++i)
    if (std::isnan(levels[i])) levels[i] = levels[i - 1];
  for (long i = kLevels - 1; i > 0; --i)
    if (std::isnan(levels[i - 1])) levels[i - 1] = levels[i];
}

/// sigma and noise of a row; `levels` holds the variances of each node of the row, whose first
/// pixel is `offset` px to the right of the first node.
PALPATE_HOT_LOOP void add_row(const float* levels, long offset, const float* z, float first,
                              float per_step, float* __restrict sigma, float* __restrict noise,
                              long columns) {
  constexpr float kPerPixel = 1.0F / static_cast<float>(kSpacing);
  for (long i = 0; i < columns; ++i) {
    const float at = (1 / z[i] - first) * per_step;
    const float level = at > 0 ? (at < kLevels - 1.001F ? at : kLevels - 1.001F) : 0;  // NaN: 0
    const auto low = static_cast<int>(level);
    const float part = level - static_cast<float>(low);
    const float across = static_cast<float>((offset + i) % kSpacing) * kPerPixel;
    const float* const node = levels + (offset + i) / kSpacing * kLevels + low;
    const float* const next = node + kLevels;
    const float left = node[0] + part * (node[1] - node[0]);
    const float right = next[0] + part * (next[1] - next[0]);
    const float variance = left + across * (right - left);
    const float square = z[i] * z[i];
    noise[i] = sigma[i];
    sigma[i] = std::sqrt(sigma[i] * sigma[i] + variance * square * square);
  }
}

}  // namespace

RigDeviation::RigDeviation(const Rig& rig, Axis axis, const Carrier& carrier, long rows,
                           long columns) {
  if (!rig.covariance) return;
  rows_ = (rows - 1) / kSpacing + 2;
  columns_ = (columns - 1) / kSpacing + 2;
  first_ = kFirstLevel / carrier.z;
  step_ = (kLastLevel - kFirstLevel) / carrier.z / (kLevels - 1);
  Eigen::Matrix2Xd pixels(2, rows_ * columns_);
  for (long row = 0; row < rows_; ++row) {
    for (long column = 0; column < columns_; ++column) {
      // The last nodes are at the border of the image, not beyond it, where lenses may fold.
      const auto v = static_cast<double>(std::min(row * kSpacing, rows - 1));
      const auto u = static_cast<double>(std::min(column * kSpacing, columns - 1));
      pixels.col(row * columns_ + column) =
          carrier.transposed ? Eigen::Vector2d(v, u) : Eigen::Vector2d(u, v);
    }
  }
  const RayView seen = look_back(rig.camera, pixels);
  table_.resize(static_cast<std::size_t>(pixels.cols() * kLevels));
  for (long level = 0; level < kLevels; ++level) {
    const double w = first_ + static_cast<double>(level) * step_;
    const Eigen::VectorXd variance = inverse_depth_variance(
        rig, panel_view(rig, axis, seen, Eigen::VectorXd::Constant(pixels.cols(), w)));
    for (Eigen::Index i = 0; i < variance.size(); ++i)
      table_[static_cast<std::size_t>(i * kLevels + level)] = static_cast<float>(variance[i]);
  }
  for (Eigen::Index i = 0; i < pixels.cols(); ++i)
    fill_levels(&table_[static_cast<std::size_t>(i * kLevels)]);
  fill_nodes();
}

void RigDeviation::fill_nodes() {
  const auto levels = [&](long row, long column) {
    return &table_[static_cast<std::size_t>((row * columns_ + column) * kLevels)];
  };
  std::vector<std::pair<long, long>> known, unknown;
  for (long row = 0; row < rows_; ++row) {
    for (long column = 0; column < columns_; ++column)
      (std::isnan(*levels(row, column)) ? unknown : known).emplace_back(row, column);
  }
  if (known.empty())
    throw InvalidInput(
        "rig: the projector lights nothing that the camera sees, so its covariance "
        "tells nothing of depths");
  for (const auto& [row, column] : unknown) {
    const auto distance = [r = row, c = column](const std::pair<long, long>& node) {
      return (node.first - r) * (node.first - r) + (node.second - c) * (node.second - c);
    };
    const auto nearest =
        std::min_element(known.begin(), known.end(),
                         [&](const auto& a, const auto& b) { return distance(a) < distance(b); });
    std::copy_n(levels(nearest->first, nearest->second), kLevels, levels(row, column));
  }
}

void RigDeviation::add(const Plane& z, const ImagePart& part, Plane& sigma, Plane& noise) const {
  noise.resize(sigma.rows(), sigma.cols());
  std::vector<float> between(static_cast<std::size_t>(columns_ * kLevels));
  for (long row = 0; row < z.rows(); ++row) {
    const auto nodes = static_cast<std::size_t>(columns_ * kLevels);
    const long down = part.row + row;
    const float share = static_cast<float>(down % kSpacing) / static_cast<float>(kSpacing);
    const float* const above = &table_[static_cast<std::size_t>(down / kSpacing) * nodes];
    for (std::size_t i = 0; i < nodes; ++i)
      between[i] = above[i] + share * (above[nodes + i] - above[i]);
    add_row(between.data(), part.column, &z(row, 0), static_cast<float>(first_),
            static_cast<float>(1 / step_), &sigma(row, 0), &noise(row, 0), z.cols());
  }
}

}  // namespace palpate::sensing
