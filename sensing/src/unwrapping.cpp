// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "unwrapping.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <vector>

#include "hue.h"
#include "plausibility.h"

namespace palpate::sensing {
namespace {

/// Pixels in the order of their variance, in classes of equal width of its square root, first come
/// first served within a class: the queue of the quality-guided flood in constant time.
class VarianceQueue {
 public:
  explicit VarianceQueue(double max_variance)
      : per_deviation_(static_cast<float>((kClasses - 1) / std::sqrt(max_variance))) {}

  void push(int pixel, float variance) {
    const int rank = std::min(static_cast<int>(std::sqrt(variance) * per_deviation_), kClasses - 1);
    classes_[static_cast<std::size_t>(rank)].all.push_back(pixel);
    lowest_ = std::min(lowest_, rank);
  }
  /// The next pixel, or -1.
  int pop() {
    for (; lowest_ < kClasses; ++lowest_) {
      Class& pixels = classes_[static_cast<std::size_t>(lowest_)];
      if (pixels.served < pixels.all.size()) return pixels.all[pixels.served++];
      pixels.all.clear();
      pixels.served = 0;
    }
    return -1;
  }

 private:
  struct Class {
    std::vector<int> all;
    std::size_t served = 0;
  };
  static constexpr int kClasses = 128;
  float per_deviation_;
  int lowest_ = kClasses;
  std::array<Class, kClasses> classes_;
};

/// The flood: from a pixel to those of its four neighbours that are free and near enough in phase.
class Flood {
 public:
  Flood(const Plane& wrapped, const Plane& variance, const FloodLimits& limits)
      : wrapped_(wrapped.data()),
        variance_(variance.data()),
        rows_(static_cast<int>(wrapped.rows())),
        columns_(static_cast<int>(wrapped.cols())),
        max_variance_(static_cast<float>(limits.max_variance)),
        max_step_(static_cast<float>(limits.max_step)),
        queue_(limits.max_variance) {}

  [[nodiscard]] bool smooth(int pixel) const { return variance_[pixel] <= max_variance_; }
  void start(int pixel) { queue_.push(pixel, variance_[pixel]); }

  /// `is_free(pixel)`; `take(pixel, phase, from)` claims one.
  template <typename IsFree, typename Take>
  void run(const float* phase, const IsFree& is_free, const Take& take) {
    for (int pixel = queue_.pop(); pixel >= 0; pixel = queue_.pop()) {
      const int column = pixel % columns_;
      const auto visit = [&](int other) {
        if (!smooth(other) || !is_free(other)) return;
        const float step = wrap(wrapped_[other] - wrapped_[pixel]);
        if (std::abs(step) > max_step_) return;
        take(other, phase[pixel] + step, pixel);
        queue_.push(other, variance_[other]);
      };
      if (column > 0) visit(pixel - 1);
      if (column + 1 < columns_) visit(pixel + 1);
      if (pixel >= columns_) visit(pixel - columns_);
      if (pixel + columns_ < rows_ * columns_) visit(pixel + columns_);
    }
  }

 private:
  const float* wrapped_;
  const float* variance_;
  int rows_;
  int columns_;
  float max_variance_;
  float max_step_;
  VarianceQueue queue_;
};

/// Half the width of the necks that are cut [px].
constexpr int kNeckRadius = 3;

/// A core of fewer pixels may lie between two stripe edges.
constexpr int kLeastCorePixels = 300;

/// Turns of the first unproven core; far from any real number.
constexpr int kUnknownTurns = 1000000;

}  // namespace

Regions grow_regions(const Plane& wrapped, const Plane& variance, const FloodLimits& limits) {
  Regions regions{Labels::Constant(wrapped.rows(), wrapped.cols(), -1), wrapped, 0};
  int* label = regions.label.data();
  float* phase = regions.phase.data();
  Flood flood(wrapped, variance, limits);
  VarianceQueue seeds(limits.max_variance);
  for (int pixel = 0; pixel < wrapped.size(); ++pixel) {
    if (flood.smooth(pixel)) seeds.push(pixel, variance.data()[pixel]);
  }
  for (int seed = seeds.pop(); seed >= 0; seed = seeds.pop()) {
    if (label[seed] >= 0) continue;
    label[seed] = regions.count++;
    flood.start(seed);
    flood.run(
        phase, [&](int pixel) { return label[pixel] < 0; },
        [&](int pixel, float value, int from) {
          label[pixel] = label[from];
          phase[pixel] = value;
        });
  }
  return regions;
}

void split_regions(const Plane& wrapped, const Plane& variance, const FloodLimits& limits,
                   const std::vector<Marker>& markers, Regions& regions) {
  // The parts of a region: its markers' turns and the labels they get. The first part keeps the
  // label.
  std::vector<std::map<int, int>> parts(static_cast<std::size_t>(regions.count));
  for (const Marker& marker : markers) {
    const int label = regions.label.data()[marker.pixel];
    auto& of_region = parts[static_cast<std::size_t>(label)];
    if (of_region.emplace(marker.turns, label).second && of_region.size() > 1) {
      of_region[marker.turns] = regions.count++;
    }
  }
  Flood flood(wrapped, variance, limits);
  const Labels before = regions.label;
  Mask done = Mask::Zero(wrapped.rows(), wrapped.cols());
  for (const Marker& marker : markers) {
    const auto& of_region = parts[static_cast<std::size_t>(before.data()[marker.pixel])];
    if (of_region.size() < 2) continue;
    regions.label.data()[marker.pixel] = of_region.at(marker.turns);
    done.data()[marker.pixel] = 1;
    flood.start(marker.pixel);
  }
  flood.run(
      regions.phase.data(), [&](int pixel) { return done.data()[pixel] == 0; },
      [&](int pixel, float, int from) {
        regions.label.data()[pixel] = regions.label.data()[from];
        done.data()[pixel] = 1;
      });
}

std::vector<Marker> mark_unproven_cores(const Plane& wrapped, const Plane& variance,
                                        const FloodLimits& limits,
                                        const std::vector<Marker>& markers) {
  const Mask smooth = (variance <= static_cast<float>(limits.max_variance)).cast<std::uint8_t>();
  Mask inner;
  erode(smooth, kNeckRadius, inner);
  const Plane inner_variance =
      (inner != 0).select(variance, std::numeric_limits<float>::infinity());
  const Regions cores = grow_regions(wrapped, inner_variance, limits);
  std::vector<int> pixels(static_cast<std::size_t>(cores.count), 0);
  std::vector<bool> proven(static_cast<std::size_t>(cores.count), false);
  for (long i = 0; i < cores.label.size(); ++i) {
    if (cores.label.data()[i] >= 0) ++pixels[static_cast<std::size_t>(cores.label.data()[i])];
  }
  for (const Marker& marker : markers) {
    const int core = cores.label.data()[marker.pixel];
    if (core >= 0) proven[static_cast<std::size_t>(core)] = true;
  }
  std::vector<Marker> result;
  for (int i = 0; i < static_cast<int>(cores.label.size()); ++i) {
    const int core = cores.label.data()[i];
    if (core < 0 || proven[static_cast<std::size_t>(core)]) continue;
    if (pixels[static_cast<std::size_t>(core)] < kLeastCorePixels) continue;
    result.push_back({i, kUnknownTurns + core});
  }
  return result;
}

}  // namespace palpate::sensing
