// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/phase_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "image/hot_loop.h"
#include "image/hue.h"

namespace palpate::sensing {
namespace {

/// Sum of the squared binomial coefficients 1 4 6 4 1: the variance of a fourth difference.
constexpr double kDifferenceVariance = 70;
/// Factor from the median of absolute values to the standard deviation of a Gaussian.
constexpr double kDeviationPerMedian = 1.4826;
/// Approximate number of samples, spaced by the reach of the averaging along the rows; pixels in
/// between have almost the same noise.
constexpr long kSamples = 4000;
/// The residual of a few pixels scatters: up to this many medians it counts as noise.
constexpr float kUsualResidual = 2;

struct NoiseSample {
  float light = 0;
  float quadrature = 0;  ///< absolute value
  float residual = 0;
};

float total_light(const PhaseSignal& signal, long row, long column) {
  float sum = 0;
  for (const Demodulated& channel : signal.channels) sum += channel.mean(row, column);
  return sum;
}

/// Samples of one row.
void add_samples(const PhaseSignal& signal, long row, long spacing,
                 std::vector<NoiseSample>& samples) {
  const float* phase = &signal.wrapped(row, 0);
  const std::uint8_t* known = &signal.modulated(row, 0);
  for (long column = 2 * spacing; column + 2 * spacing < signal.wrapped.cols(); column += spacing) {
    bool all = true;
    for (long i = -2; i <= 2; ++i) all = all && known[column + i * spacing] != 0;
    if (!all) continue;
    std::array<float, 4> step{};
    for (long i = 0; i < 4; ++i) {
      const long left = column + (i - 2) * spacing;
      step[static_cast<std::size_t>(i)] = wrap(phase[left + spacing] - phase[left]);
    }
    const float difference = step[3] - 3 * step[2] + 3 * step[1] - step[0];
    const float amplitude =
        std::hypot(signal.combined.re(row, column), signal.combined.im(row, column));
    samples.push_back({total_light(signal, row, column), std::abs(amplitude * difference),
                       signal.residual(row, column)});
  }
}

struct Coefficients {
  float noise_constant = 0;
  float noise_slope = 0;
  float residual_constant = 0;
  float residual_slope = 0;
  float coherent = 0;
};

/// One row of the input for predicting deviations.
struct SigmaInputRow {
  const float* re;
  const float* im;
  const float* residual;
  std::array<const float*, 3> means;  ///< of the channels, whose sum is the light
};

PALPATE_HOT_LOOP void find_sigma(const SigmaInputRow& row, const Coefficients& coefficients,
                                 long columns, float* __restrict sigma) {
  const SigmaInputRow r = row;
  const Coefficients c = coefficients;
  for (long i = 0; i < columns; ++i) {
    const float light = r.means[0][i] + r.means[1][i] + r.means[2][i];
    const float excess = r.residual[i] - (c.residual_constant + c.residual_slope * light);
    const float noise = c.noise_constant + c.noise_slope * light;
    const float variance = noise + c.coherent * (excess > 0 ? excess : 0.0F);
    const float power = r.re[i] * r.re[i] + r.im[i] * r.im[i];
    sigma[i] = std::sqrt(variance / power);
  }
}

PALPATE_HOT_LOOP void add_variance(const float* red, const float* blue, float of_red, float of_blue,
                                   long count, float* __restrict sigma) {
  for (long i = 0; i < count; ++i) {
    sigma[i] =
        std::sqrt(sigma[i] * sigma[i] + of_red * red[i] * red[i] + of_blue * blue[i] * blue[i]);
  }
}

}  // namespace

FrameNoise estimate_noise(const PhaseSignal& signal, const DemodulationFilter& filter) {
  const long spacing = filter.width();
  const long rows = signal.wrapped.rows();
  const long step = std::max<long>(1, signal.wrapped.size() / (spacing * kSamples));
  std::vector<NoiseSample> samples;
  samples.reserve(static_cast<std::size_t>(2 * kSamples));
  for (long row = step / 2; row < rows; row += step) add_samples(signal, row, spacing, samples);
  const std::size_t count = std::min(kLightGroups, samples.size() / kLeastInGroup);
  std::vector<LightGroup> quadrature, residual;
  for (const std::span<NoiseSample> group : light_groups(samples, count)) {
    const auto light = static_cast<double>(group[group.size() / 2].light);
    residual.push_back({light, median_of(group, &NoiseSample::residual)});
    const double deviation = kDeviationPerMedian * median_of(group, &NoiseSample::quadrature);
    quadrature.push_back({light, deviation * deviation / kDifferenceVariance});
  }
  return {fit_light(quadrature), fit_light(residual)};
}

void predict_phase_sigma(const PhaseSignal& signal, const FrameNoise& noise,
                         const DemodulationFilter& filter, Plane& sigma) {
  double squares = 0;
  for (std::size_t k = 0; k < filter.weight.size(); ++k) {
    const auto weight = static_cast<double>(filter.weight[k]);
    squares += (k == 0 ? 1 : 2) * weight * weight;
  }
  const Coefficients model{
      .noise_constant = static_cast<float>(noise.quadrature.constant),
      .noise_slope = static_cast<float>(noise.quadrature.slope),
      .residual_constant = kUsualResidual * static_cast<float>(noise.residual.constant),
      .residual_slope = kUsualResidual * static_cast<float>(noise.residual.slope),
      .coherent = static_cast<float>(squares / 2)};
  sigma.resize(signal.wrapped.rows(), signal.wrapped.cols());
  const std::vector<float> zeros(static_cast<std::size_t>(sigma.cols()), 0.0F);
  for (long row = 0; row < sigma.rows(); ++row) {
    SigmaInputRow values{.re = &signal.combined.re(row, 0),
                         .im = &signal.combined.im(row, 0),
                         .residual = &signal.residual(row, 0),
                         .means = {zeros.data(), zeros.data(), zeros.data()}};
    for (std::size_t i = 0; i < signal.channels.size(); ++i) {
      values.means.at(i) = &signal.channels[i].mean(row, 0);
    }
    find_sigma(values, model, sigma.cols(), &sigma(row, 0));
  }
}

void add_chromatic_error(const ChannelShares& shares, const ChromaticError& error, Plane& sigma) {
  if (!(error.red > 0) && !(error.blue > 0)) return;
  add_variance(shares.red.data(), shares.blue.data(), static_cast<float>(error.red),
               static_cast<float>(error.blue), sigma.size(), sigma.data());
}

}  // namespace palpate::sensing
