// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "demodulation.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <numbers>

#include "hot_loop.h"

namespace palpate::sensing {
namespace {

/// At a border a sinusoid and a mean are told apart only if the window still holds enough of a
/// period: the smallest pivot of the normal equations, which is 1/2 in a whole window, must exceed
/// this.
constexpr double kLeastPivot = 0.05;

/// And so much of the window's weight: where less is left, the pixel lies so far off the middle of
/// what is that a slope of the brightness or of the phase passes for a phase.
constexpr double kLeastWeight = 0.85;

/// Adds the pixels k rows above and below: even and odd part of the window.
PALPATE_HOT_LOOP void add_rows(const float* above, const float* below, long columns, float weight,
                               float cosine, float sine, float* mean, float* re, float* im) {
  for (long i = 0; i < columns; ++i) {
    const float sum = above[i] + below[i];
    const float difference = below[i] - above[i];
    mean[i] += weight * sum;
    re[i] += cosine * sum;
    im[i] -= sine * difference;
  }
}

/// The normal equations of a whole window: its symmetry leaves the sine alone.
struct WholeWindow {
  float cosine = 0;        ///< sum of weight * cos
  float cosine_scale = 0;  ///< 1 / (sum of weight * cos^2 - cosine^2)
  float sine_scale = 0;    ///< 1 / sum of weight * sin^2
};

/// Sums over whole windows to mean and half amplitudes.
PALPATE_HOT_LOOP void solve_row(float* mean, float* re, float* im, long columns,
                                WholeWindow whole) {
  for (long i = 0; i < columns; ++i) {
    const float amplitude = whole.cosine_scale * (re[i] - whole.cosine * mean[i]);
    mean[i] -= whole.cosine * amplitude;
    re[i] = 0.5F * amplitude;
    im[i] = 0.5F * whole.sine_scale * im[i];
  }
}

PALPATE_HOT_LOOP void rotate_row(float* re, float* im, long columns, float cosine, float sine) {
  for (long i = 0; i < columns; ++i) {
    const float turned = re[i] * cosine + im[i] * sine;
    im[i] = im[i] * cosine - re[i] * sine;
    re[i] = turned;
  }
}

PALPATE_HOT_LOOP void smooth_row(const float* in, float* out, long columns) {
  for (long i = 2; i + 2 < columns; ++i) {
    out[i] = (in[i - 2] + in[i + 2] + 4 * (in[i - 1] + in[i + 1]) + 6 * in[i]) / 16;
  }
}

/// For each pixel: how many pixels of the mask its window holds, image borders counting as outside.
class WindowCount {
 public:
  WindowCount(const Mask& mask, int radius)
      : mask_(mask), radius_(radius), count_(static_cast<std::size_t>(mask.cols())) {
    for (long row = 0; row < std::min<long>(radius, mask.rows()); ++row) add(row, 1);
  }
  /// To be called for rows 0, 1, 2, ... in turn.
  const std::vector<int>& row(long row) {
    if (row + radius_ < mask_.rows()) add(row + radius_, 1);
    if (row - radius_ - 1 >= 0) add(row - radius_ - 1, -1);
    return count_;
  }

 private:
  void add(long row, int sign) {
    const std::uint8_t* values = &mask_(row, 0);
    for (std::size_t i = 0; i < count_.size(); ++i) count_[i] += sign * values[i];
  }
  const Mask& mask_;
  long radius_;
  std::vector<int> count_;
};

/// cos and sin of the carrier at k = -radius ... radius, and the weights.
struct Taps {
  explicit Taps(const DemodulationFilter& filter) {
    for (int k = -filter.radius; k <= filter.radius; ++k) {
      weight.push_back(static_cast<double>(filter.weight[static_cast<std::size_t>(std::abs(k))]));
      cosine.push_back(std::cos(filter.carrier * k));
      sine.push_back(std::sin(filter.carrier * k));
    }
  }
  [[nodiscard]] WholeWindow whole_window() const {
    double sum = 0;
    double cosines = 0;
    double sines = 0;
    for (std::size_t k = 0; k < weight.size(); ++k) {
      sum += weight[k] * cosine[k];
      cosines += weight[k] * cosine[k] * cosine[k];
      sines += weight[k] * sine[k] * sine[k];
    }
    return {static_cast<float>(sum), static_cast<float>(1 / (cosines - sum * sum)),
            static_cast<float>(1 / sines)};
  }
  std::vector<double> weight;
  std::vector<double> cosine;
  std::vector<double> sine;
};

/// Least squares in a window that is cut by the mask. Writes zeros where the fit is not determined.
void fit_cut_window(const std::vector<Plane>& channels, const Mask& mask, const Taps& taps,
                    int radius, long row, long column, std::vector<Demodulated>& out) {
  const long first = std::max<long>(0, row - radius);
  const long last = std::min<long>(mask.rows() - 1, row + radius);
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  std::array<Eigen::Vector3d, 3> right;
  right.fill(Eigen::Vector3d::Zero());
  for (long other = first; other <= last; ++other) {
    if (mask(other, column) == 0) continue;
    const auto k = static_cast<std::size_t>(other - row + radius);
    const Eigen::Vector3d basis(1, taps.cosine[k], -taps.sine[k]);
    const Eigen::Vector3d weighted = taps.weight[k] * basis;
    normal += weighted * basis.transpose();
    for (std::size_t i = 0; i < channels.size(); ++i) {
      right[i] += static_cast<double>(channels[i](other, column)) * weighted;
    }
  }
  const double total = normal(0, 0);
  const Eigen::LDLT<Eigen::Matrix3d> solver(normal / total);
  const bool centered = total >= kLeastWeight;
  const bool determined = total > 0 && solver.vectorD().minCoeff() > kLeastPivot;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    const Eigen::Vector3d fit =
        determined ? Eigen::Vector3d(solver.solve(right[i] / total)) : Eigen::Vector3d::Zero();
    out[i].mean(row, column) = static_cast<float>(fit[0]);
    out[i].re(row, column) = centered ? static_cast<float>(fit[1] / 2) : 0;
    out[i].im(row, column) = centered ? static_cast<float>(fit[2] / 2) : 0;
  }
}

/// Windows that lie wholly in the mask: plain convolution of one row.
void convolve_row(const Plane& channel, const DemodulationFilter& filter, long row,
                  Demodulated& out) {
  const long last = channel.rows() - 1;
  for (int k = 0; k <= filter.radius; ++k) {
    const float weight = filter.weight[static_cast<std::size_t>(k)] * (k == 0 ? 0.5F : 1.0F);
    const auto cosine = static_cast<float>(std::cos(filter.carrier * k));
    const auto sine = static_cast<float>(std::sin(filter.carrier * k));
    add_rows(&channel(std::max<long>(0, row - k), 0), &channel(std::min(last, row + k), 0),
             channel.cols(), weight, weight * cosine, weight * sine, &out.mean(row, 0),
             &out.re(row, 0), &out.im(row, 0));
  }
}

}  // namespace

DemodulationFilter make_filter(double carrier) {
  const double period = 2 * std::numbers::pi / std::abs(carrier);
  DemodulationFilter filter{
      .radius = static_cast<int>(std::floor(period)), .carrier = carrier, .weight = {}};
  double total = 0;
  std::vector<double> weights;
  for (int k = 0; k <= filter.radius; ++k) {
    weights.push_back(0.5 + 0.5 * std::cos(std::numbers::pi * k / period));
    total += (k == 0 ? 1 : 2) * weights.back();
  }
  for (const double weight : weights) filter.weight.push_back(static_cast<float>(weight / total));
  return filter;
}

std::vector<Demodulated> demodulate(const std::vector<Plane>& channels, const Mask& mask,
                                    const DemodulationFilter& filter) {
  const Plane zero = Plane::Zero(mask.rows(), mask.cols());
  std::vector<Demodulated> result(channels.size(), Demodulated{zero, zero, zero});
  const Taps taps(filter);
  WindowCount counts(mask, filter.radius);
  const WholeWindow whole = taps.whole_window();
  const int whole_count = 2 * filter.radius + 1;
  for (long row = 0; row < mask.rows(); ++row) {
    const std::vector<int>& count = counts.row(row);
    for (std::size_t i = 0; i < channels.size(); ++i) {
      Demodulated& out = result[i];
      convolve_row(channels[i], filter, row, out);
      solve_row(&out.mean(row, 0), &out.re(row, 0), &out.im(row, 0), mask.cols(), whole);
    }
    for (long column = 0; column < mask.cols(); ++column) {
      if (mask(row, column) == 0) {
        for (Demodulated& out : result)
          out.re(row, column) = out.im(row, column) = out.mean(row, column) = 0;
      } else if (count[static_cast<std::size_t>(column)] != whole_count) {
        fit_cut_window(channels, mask, taps, filter.radius, row, column, result);
      }
    }
    const std::complex<double> turn = std::polar(1.0, filter.carrier * static_cast<double>(row));
    for (Demodulated& out : result) {
      rotate_row(&out.re(row, 0), &out.im(row, 0), mask.cols(), static_cast<float>(turn.real()),
                 static_cast<float>(turn.imag()));
    }
  }
  return result;
}

void smooth_rows(Demodulated& signal) {
  Plane* const parts[] = {&signal.re, &signal.im};
  for (Plane* part : parts) {
    Plane smoothed = *part;
    for (long row = 0; row < part->rows(); ++row) {
      smooth_row(&(*part)(row, 0), &smoothed(row, 0), part->cols());
    }
    *part = std::move(smoothed);
  }
}

}  // namespace palpate::sensing
