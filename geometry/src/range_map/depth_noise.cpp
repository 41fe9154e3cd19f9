// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/depth_noise.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/quantile.h"

namespace palpate::geometry {
namespace {

// Depths are divided into kRanges ranges of as many pixels each, at least kLeastInRange.
constexpr std::size_t kRanges = 16, kLeastInRange = 100;
// A pixel whose variance is more than this many times the median of its range is left out.
constexpr double kOutlier = 16;
// Something moves if the variance is more than this many times that from frame to frame. Filters
// over time, which many cameras have, reach 2.5.
constexpr double kDrift = 3;

// A pixel that has a depth in all frames.
struct Pixel {
  double z = 0;         // [mm] mean
  double variance = 0;  // [mm^2]
  double step = 0;      // [mm^2] the same from differences of successive frames
};

std::vector<Pixel> known_pixels(std::span<const ImageF> still) {
  const auto count = static_cast<double>(still.size());
  std::vector<Pixel> pixels;
  for (Eigen::Index i = 0; i < still.front().size(); ++i) {
    if (!std::ranges::all_of(still, [&](const ImageF& frame) {
          return frame.data()[i] > 0 && std::isfinite(frame.data()[i]);
        }))
      continue;
    const double first = still.front().data()[i];
    Pixel pixel{.z = first};
    // As differences, so that equal depths have no variance.
    for (const ImageF& frame : still)
      pixel.z += (static_cast<double>(frame.data()[i]) - first) / count;
    for (std::size_t k = 0; k < still.size(); ++k) {
      const double z = still[k].data()[i];
      pixel.variance += std::pow(z - pixel.z, 2) / (count - 1);
      if (k > 0)
        pixel.step +=
            std::pow(z - static_cast<double>(still[k - 1].data()[i]), 2) / 2 / (count - 1);
    }
    pixels.push_back(pixel);
  }
  return pixels;
}

// Means over the pixels of a range of depths that are no outliers.
Pixel typical(std::span<const Pixel> range, double least_variance) {
  std::vector<double> variances;
  for (const Pixel& pixel : range) variances.push_back(pixel.variance);
  const double most = kOutlier * std::max(median(variances), least_variance);
  Pixel sum;
  double count = 0;
  for (const Pixel& pixel : range) {
    if (pixel.variance > most) continue;
    sum.z += pixel.z;
    sum.variance += pixel.variance;
    sum.step += pixel.step;
    ++count;
  }
  return {sum.z / count, sum.variance / count, sum.step / count};
}

// Least-squares fit of the relative errors of deviations, with no part below 0.
DepthNoise fitted(const std::vector<Pixel>& ranges) {
  constexpr double kLeastVariance = 1e-6;  // that counts, relative to the largest
  const double largest = std::ranges::max(ranges, {}, &Pixel::variance).variance;
  if (largest == 0) return {};
  double n = 0, q = 0, qq = 0, s = 0, qs = 0;  // sums of 1, z^2, z^4, deviation, z^2 deviation
  for (const Pixel& range : ranges) {
    const double weight = 1 / std::max(range.variance, kLeastVariance * largest);
    const double square = range.z * range.z, deviation = std::sqrt(range.variance);
    n += weight;
    q += weight * square;
    qq += weight * square * square;
    s += weight * deviation;
    qs += weight * square * deviation;
  }
  constexpr double kSameDepth = 1e-3;  // of the determinant, relative to its first term
  const double determinant = n * qq - q * q;
  if (!(determinant > kSameDepth * n * qq)) return {.constant = s / n, .quadratic = 0};
  const DepthNoise both{.constant = (qq * s - q * qs) / determinant,
                        .quadratic = (n * qs - q * s) / determinant};
  if (both.quadratic < 0) return {.constant = s / n, .quadratic = 0};
  if (both.constant < 0) return {.constant = 0, .quadratic = qs / qq};
  return both;
}

}  // namespace

DepthNoise depth_noise(std::span<const ImageF> still, double resolution) {
  if (std::ssize(still) < kStillFrames) {
    throw InvalidInput("the noise of a camera needs at least " + std::to_string(kStillFrames) +
                       " frames of a scene that does not move; there are " +
                       std::to_string(still.size()));
  }
  for (const ImageF& frame : still) {
    if (frame.rows() != still.front().rows() || frame.cols() != still.front().cols())
      throw InvalidInput("the frames of the scene that does not move differ in size");
  }
  std::vector<Pixel> pixels = known_pixels(still);
  if (pixels.size() < kLeastInRange) {
    throw InvalidInput("only " + std::to_string(pixels.size()) +
                       " pixels have a depth in all frames of the scene that does not move; at "
                       "least " +
                       std::to_string(kLeastInRange) + " are needed");
  }
  std::ranges::stable_sort(pixels, {}, &Pixel::z);
  const double rounding = resolution * resolution / 12;
  const std::size_t count = std::min(kRanges, pixels.size() / kLeastInRange);
  std::vector<Pixel> ranges;
  double variance = 0, step = 0;
  for (std::size_t r = 0; r < count; ++r) {
    const std::size_t begin = r * pixels.size() / count, end = (r + 1) * pixels.size() / count;
    Pixel range = typical(std::span(pixels).subspan(begin, end - begin), rounding);
    variance += range.variance;
    step += range.step;
    range.variance = std::max(range.variance, rounding);
    ranges.push_back(range);
  }
  if (variance > kDrift * step) {
    throw InvalidInput(
        "the depths drift from frame to frame; the noise of a camera needs frames of a scene that "
        "does not move");
  }
  return fitted(ranges);
}

ImageF deviations(const DepthNoise& noise, const ImageF& z) {
  return z.unaryExpr([&](float depth) {
    return depth > 0 ? static_cast<float>(noise.deviation(static_cast<double>(depth)))
                     : std::numeric_limits<float>::quiet_NaN();
  });
}

}  // namespace palpate::geometry
