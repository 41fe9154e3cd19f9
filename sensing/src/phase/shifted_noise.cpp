// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/shifted_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <span>

#include "image/hue.h"

namespace palpate::sensing {
namespace {

/// Sum of the squared binomial coefficients 1 4 6 4 1.
constexpr double kFourthDifference = 70;
/// Pixels between those of a difference: beyond the reach of demosaicing.
constexpr long kDifferenceStep = 4;
/// Approximate number of differences.
constexpr long kDifferences = 8000;

/// Variance of the blur by lens and demosaicing [px^2].
constexpr float kMixingBlur = 2;
/// The amplitude at the very edge of a surface, with such a blur, changes by this share per pixel
/// [1/px]: sqrt(2 / (pi V)), a little more beyond.
constexpr float kMostFade = 0.6F;
/// A change of the amplitude counts from this number of standard deviations on.
constexpr float kClearFade = 3;

/// Median of the mean square of `freedom` normal values of variance one (Wilson and Hilferty 1931).
double median_of_chi2(int freedom) {
  const double k = freedom;
  return std::pow(1 - 2 / (9 * k), 3);
}

}  // namespace

LinearInLight variance_of_light(std::vector<VarianceSample> samples, int freedom) {
  if (samples.empty()) return {};
  const std::size_t count =
      std::clamp(samples.size() / kLeastInGroup, std::size_t{1}, kLightGroups);
  std::vector<LightGroup> groups;
  for (const std::span<VarianceSample> group : light_groups(samples, count)) {
    const auto light = static_cast<double>(group[group.size() / 2].light);
    groups.push_back(
        {light, median_of(group, &VarianceSample::variance) / median_of_chi2(freedom)});
  }
  return fit_light(groups);
}

std::vector<VarianceSample> samples_between_pixels(const ShiftedChannel& channel,
                                                   double unit_variance, float least_amplitude) {
  std::vector<VarianceSample> samples;
  const long rows = channel.re.rows();
  const long columns = channel.re.cols();
  const long step = std::max<long>(1, rows * columns / kDifferences);
  constexpr long kReach = 4 * kDifferenceStep;
  for (long place = step / 2; place < rows * columns; place += step) {
    const long row = place / columns;
    const long column = place % columns;
    if (column + kReach >= columns) continue;
    std::array<float, 5> phase{};
    bool known = true;
    for (long i = 0; i < 5; ++i) {
      const long at = column + i * kDifferenceStep;
      known = known && channel.count(row, at) > 0 &&
              std::hypot(channel.re(row, at), channel.im(row, at)) >= least_amplitude;
      phase[static_cast<std::size_t>(i)] = std::atan2(channel.im(row, at), channel.re(row, at));
    }
    if (!known) continue;
    std::array<float, 4> first{};
    for (std::size_t i = 0; i < 4; ++i) first[i] = wrap(phase[i + 1] - phase[i]);
    // Differences of wrapped differences stay small where the phase runs evenly.
    const float fourth =
        wrap(wrap(first[3] - first[2]) - 2 * wrap(first[2] - first[1]) + wrap(first[1] - first[0]));
    const long middle = column + 2 * kDifferenceStep;
    const float amplitude = std::hypot(channel.re(row, middle), channel.im(row, middle));
    const float deviation = amplitude * fourth;
    const float count = channel.count(row, middle);
    samples.push_back(
        {channel.mean(row, middle) / count,
         deviation * deviation / static_cast<float>(kFourthDifference * unit_variance) / count});
  }
  return samples;
}

double beyond_chance(int freedom) {
  constexpr double kDeviations = 3.719;  // one in ten thousand
  const double k = freedom;
  return std::pow(1 - 2 / (9 * k) + kDeviations * std::sqrt(2 / (9 * k)), 3);
}

void add_mixed_light(const Combined& combined, const Plane& count, double along, Plane& sigma,
                     Mask& edges) {
  edges.setZero(sigma.rows(), sigma.cols());
  for (long row = 1; row + 1 < sigma.rows(); ++row) {
    for (long column = 1; column + 1 < sigma.cols(); ++column) {
      if (std::isnan(sigma(row, column))) continue;
      const auto phasor = [&](long down, long right) {
        return std::complex<float>(combined.re(row + down, column + right),
                                   combined.im(row + down, column + right));
      };
      const float power = std::norm(phasor(0, 0));
      float off = 0, slopes = 0, fades = 0;
      const auto add = [&](long down, long right, float carrier) {
        if (count(row - down, column - right) != count(row + down, column + right)) return;
        const auto before = phasor(-down, -right);
        const auto after = phasor(down, right);
        const float fade = (std::norm(after) - std::norm(before)) / (4 * power);
        const float slope = std::arg(after * std::conj(before)) / 2 + carrier;
        off += fade * slope;
        slopes += slope * slope;
        fades += fade * fade;
      };
      add(1, 0, static_cast<float>(along));
      add(0, 1, 0);
      edges(row, column) = fades > kMostFade * kMostFade ? 1 : 0;
      // The noise of `off` is that of an amplitude, sigma, times slope / sqrt(2).
      const float variance = sigma(row, column) * sigma(row, column);
      if (off * off > kClearFade * kClearFade * slopes * variance / 2)
        sigma(row, column) = std::sqrt(variance + kMixingBlur * kMixingBlur * off * off);
    }
  }
}

}  // namespace palpate::sensing
