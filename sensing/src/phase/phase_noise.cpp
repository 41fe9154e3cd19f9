// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/phase_noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
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
/// Number of groups of similar brightness, and smallest number of samples in one.
constexpr std::size_t kBrightnessGroups = 8;
constexpr std::size_t kLeastSamples = 50;
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

template <typename Value>
double median(std::vector<NoiseSample>::iterator first, std::vector<NoiseSample>::iterator last,
              Value value) {
  const auto middle = first + (last - first) / 2;
  std::nth_element(first, middle, last,
                   [&](const NoiseSample& a, const NoiseSample& b) { return value(a) < value(b); });
  return static_cast<double>(value(*middle));
}

/// Values of groups as a function of their light.
struct Points {
  std::vector<double> light;
  std::vector<double> value;
};

/// Least squares of the relative deviations; a term that would become negative is left out.
LinearInLight fit_line(const Points& points) {
  double n = 0;
  double constants = 0;
  double products = 0;
  double slopes = 0;
  double right_constant = 0;
  double right_slope = 0;
  for (std::size_t i = 0; i < points.value.size(); ++i) {
    if (!(points.value[i] > 0)) continue;
    const double a = 1 / points.value[i];
    const double b = points.light[i] / points.value[i];
    n += 1;
    constants += a * a;
    products += a * b;
    slopes += b * b;
    right_constant += a;
    right_slope += b;
  }
  if (n == 0) return {};
  const double determinant = constants * slopes - products * products;
  /// If the product of the two diagonal elements is below this share, all groups are equally
  /// bright.
  constexpr double kLeastDeterminant = 1e-6;
  if (determinant > kLeastDeterminant * constants * slopes) {
    const LinearInLight line{(slopes * right_constant - products * right_slope) / determinant,
                             (constants * right_slope - products * right_constant) / determinant};
    if (line.constant >= 0 && line.slope >= 0) return line;
    if (line.constant < 0) return {0, right_slope / slopes};
  }
  return {right_constant / constants, 0};
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
  std::sort(samples.begin(), samples.end(),
            [](const NoiseSample& a, const NoiseSample& b) { return a.light < b.light; });
  const std::size_t groups = std::min(kBrightnessGroups, samples.size() / kLeastSamples);
  Points quadrature;
  Points residual;
  for (std::size_t group = 0; group < groups; ++group) {
    const auto first = samples.begin() + static_cast<long>(group * samples.size() / groups);
    const auto last = samples.begin() + static_cast<long>((group + 1) * samples.size() / groups);
    const double light = static_cast<double>((first + (last - first) / 2)->light);
    quadrature.light.push_back(light);
    residual.light.push_back(light);
    residual.value.push_back(median(first, last, [](const NoiseSample& s) { return s.residual; }));
    const double deviation = kDeviationPerMedian *
                             median(first, last, [](const NoiseSample& s) { return s.quadrature; });
    quadrature.value.push_back(deviation * deviation / kDifferenceVariance);
  }
  return {fit_line(quadrature), fit_line(residual)};
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
