// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "phase/local_frequency.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>

#include "image/hot_loop.h"
#include "phase/row_average.h"

namespace palpate::sensing {
namespace {

/// Response to cos((carrier + delta) k + phase), averaged over the phase.
struct FitResponse {
  double own = 0;       ///< G
  double mirror = 0;    ///< H
  double residual = 0;  ///< remaining part of its power
};

/// The fit of mean and sinusoid as sums over the window, k = -radius ... radius.
class SinusoidFit {
 public:
  explicit SinusoidFit(const DemodulationFilter& filter) : carrier_(filter.carrier) {
    const int size = 2 * filter.radius + 1;
    basis_.resize(size, 3);
    weight_.resize(size);
    for (int i = 0; i < size; ++i) {
      const int k = i - filter.radius;
      basis_.row(i) << 1, std::cos(carrier_ * k), -std::sin(carrier_ * k);
      weight_[i] = static_cast<double>(filter.weight[static_cast<std::size_t>(std::abs(k))]);
    }
    const Eigen::MatrixXd weighted = weight_.cwiseSqrt().asDiagonal() * basis_;
    solve_ = weighted.householderQr().solve(Eigen::MatrixXd(weight_.cwiseSqrt().asDiagonal()));
  }
  /// [px] Quadrature of light that changes by one per row.
  [[nodiscard]] double leak() const {
    const auto radius = static_cast<double>(weight_.size() / 2);
    return solve_.row(2).dot(Eigen::RowVectorXd::LinSpaced(weight_.size(), -radius, radius));
  }
  /// Response of the fit, with shading removed by its means `reach` rows up and down.
  [[nodiscard]] FitResponse response(double delta, int reach) const {
    FitResponse result;
    for (const double phase : {0.0, std::numbers::pi / 2}) {
      const Eigen::VectorXd here = wave(delta, phase, 0);
      Eigen::Vector3d fit = solve_ * here;
      result.residual += (here - basis_ * fit).cwiseAbs2().dot(weight_) / 2;
      const double change =
          solve_.row(0).dot(wave(delta, phase, reach) - wave(delta, phase, -reach));
      fit[2] -= leak() * change / (2 * reach);
      // G exp(i phase) + H exp(-i phase), twice the half amplitudes being the fit's.
      const std::complex<double> found =
          std::complex<double>(fit[1], fit[2]) * std::polar(1.0, -phase);
      result.own += found.real() / 2;
      result.mirror += (phase == 0 ? 1 : -1) * found.real() / 2;
    }
    return result;
  }

 private:
  /// The sinusoid in the window `rows` rows further down.
  [[nodiscard]] Eigen::VectorXd wave(double delta, double phase, int rows) const {
    const double first = static_cast<double>(rows) - static_cast<double>(weight_.size() / 2);
    Eigen::VectorXd values(weight_.size());
    for (long i = 0; i < values.size(); ++i)
      values[i] = std::cos((carrier_ + delta) * (static_cast<double>(i) + first) + phase);
    return values;
  }

  double carrier_;
  Eigen::MatrixXd basis_;
  Eigen::VectorXd weight_;
  Eigen::MatrixXd solve_;
};

/// `scale` times the change of the mean from one row to another; zero unless both and the row in
/// the middle are known.
PALPATE_HOT_LOOP void find_shading(const float* above, const float* here, const float* below,
                                   float scale, long columns, float* __restrict shading) {
  for (long i = 0; i < columns; ++i) {
    const bool known = (above[i] != 0) & (here[i] != 0) & (below[i] != 0);
    shading[i] = known ? scale * (below[i] - above[i]) : 0.0F;
  }
}

/// Subtracts i shading * (cosine - i sine) from re + i im.
PALPATE_HOT_LOOP void subtract_shading(const float* shading, float cosine, float sine, long columns,
                                       float* __restrict re, float* __restrict im) {
  for (long i = 0; i < columns; ++i) {
    re[i] -= sine * shading[i];
    im[i] -= cosine * shading[i];
  }
}

PALPATE_HOT_LOOP void add_product(const float* re_above, const float* im_above,
                                  const float* re_below, const float* im_below, const float* re,
                                  const float* im, long columns, float* __restrict product_re,
                                  float* __restrict product_im, float* __restrict squares) {
  for (long i = 0; i < columns; ++i) {
    product_re[i] += re_below[i] * re_above[i] + im_below[i] * im_above[i];
    product_im[i] += im_below[i] * re_above[i] - re_below[i] * im_above[i];
    squares[i] += re[i] * re[i] + im[i] * im[i];
  }
}

/// atan2 to 1e-5 rad; zero of zero and zero.
inline float angle(float y, float x) {
  const float far = std::abs(x);
  const float side = std::abs(y);
  const float high = far > side ? far : side;
  const float low = far > side ? side : far;
  const float t = high > 0 ? low / high : 0.0F;
  const float s = t * t;
  const float inner =
      t * (0.99997726F +
           s * (-0.33262347F +
                s * (0.19354346F + s * (-0.11643287F + s * (0.05265332F - s * 0.01172120F)))));
  const float folded = side > far ? std::numbers::pi_v<float> / 2 - inner : inner;
  const float upper = x < 0 ? std::numbers::pi_v<float> - folded : folded;
  return y < 0 ? -upper : upper;
}

struct Polynomials {
  float coefficient[LocalFrequency::kDegree + 1];
};

inline float value(const Polynomials& polynomial, float x) {
  float sum = polynomial.coefficient[LocalFrequency::kDegree];
  for (int i = LocalFrequency::kDegree - 1; i >= 0; --i) sum = sum * x + polynomial.coefficient[i];
  return sum;
}

/// Replaces `product_re` by the ripple, and subtracts the sinusoid's part from the residual.
PALPATE_HOT_LOOP void find_ripple(float* __restrict product_re, const float* product_im,
                                  const float* squares, float per_angle, float largest,
                                  Polynomials ripple, Polynomials power, long columns,
                                  float* __restrict residual) {
  for (long i = 0; i < columns; ++i) {
    const float change = per_angle * angle(product_im[i], product_re[i]);
    const float delta = std::abs(change) <= largest ? change : 0.0F;
    product_re[i] = value(ripple, delta);
    const float left = residual[i] - squares[i] * value(power, delta);
    residual[i] = left > 0 ? left : 0.0F;
  }
}

/// Subtracts ripple * conj(z) * (cosine - i sine) from z.
PALPATE_HOT_LOOP void remove_ripple(const float* ripple, float cosine, float sine, long columns,
                                    float* __restrict re, float* __restrict im) {
  for (long i = 0; i < columns; ++i) {
    const float mirror_re = cosine * re[i] - sine * im[i];
    const float mirror_im = -sine * re[i] - cosine * im[i];
    re[i] -= ripple[i] * mirror_re;
    im[i] -= ripple[i] * mirror_im;
  }
}

Polynomials coefficients(const LocalFrequency::Polynomial& polynomial) {
  Polynomials result{};
  std::copy_n(polynomial.data(), polynomial.size(), result.coefficient);
  return result;
}

}  // namespace

LocalFrequency::LocalFrequency(const DemodulationFilter& filter)
    : reach_(static_cast<int>(std::lround(filter.period() / 2))),
      carrier_(filter.carrier),
      averages_(filter.averages) {
  constexpr int kNodes = 8 * kDegree;
  const SinusoidFit fit(filter);
  leak_ = fit.leak() / 2;
  const double largest = kLargestDeviation * std::abs(carrier_);
  Eigen::MatrixXd powers(kNodes,
                         kDegree);  // of delta, from the first: both polynomials vanish at 0
  Eigen::VectorXd ripple(kNodes);
  Eigen::VectorXd power(kNodes);
  for (int i = 0; i < kNodes; ++i) {
    const double delta = largest * std::cos(std::numbers::pi * (i + 0.5) / kNodes);
    for (int degree = 1; degree <= kDegree; ++degree)
      powers(i, degree - 1) = std::pow(delta / largest, degree);
    const FitResponse response = fit.response(delta, reach_);
    ripple[i] = response.mirror / response.own;
    // An amplitude a leaves the residual a^2 residual and is measured as re^2 + im^2 = (a own /
    // 2)^2.
    power[i] = 4 * response.residual / (response.own * response.own);
  }
  const Eigen::HouseholderQR<Eigen::MatrixXd> qr(powers);
  const auto scaled = [&](const Eigen::VectorXd& fitted) {
    Polynomial result = Polynomial::Zero();
    for (int degree = 1; degree <= kDegree; ++degree)
      result[degree] = static_cast<float>(fitted[degree - 1] / std::pow(largest, degree));
    return result;
  };
  ripple_ = scaled(qr.solve(ripple));
  power_ = scaled(qr.solve(power));
}

void LocalFrequency::remove_shading(long row, Demodulation& signal) {
  const long columns = signal.residual.cols();
  shading_.resize(columns);
  smooth_shading_.resize(columns);
  const double turn = carrier_ * static_cast<double>(row);
  for (Demodulated& channel : signal.channels) {
    find_shading(&channel.mean(row - reach_, 0), &channel.mean(row, 0),
                 &channel.mean(row + reach_, 0), static_cast<float>(leak_ / (2 * reach_)), columns,
                 shading_.data());
    average_row(shading_.data(), averages_, smooth_shading_.data(), columns);
    subtract_shading(smooth_shading_.data(), static_cast<float>(std::cos(turn)),
                     static_cast<float>(std::sin(turn)), columns, &channel.re(row, 0),
                     &channel.im(row, 0));
  }
}

void LocalFrequency::adapt(long row, Demodulation& signal) {
  const long columns = signal.residual.cols();
  for (Eigen::ArrayXf* sum : {&product_re_, &product_im_, &squares_}) sum->setZero(columns);
  for (const Demodulated& channel : signal.channels) {
    add_product(&channel.re(row - reach_, 0), &channel.im(row - reach_, 0),
                &channel.re(row + reach_, 0), &channel.im(row + reach_, 0), &channel.re(row, 0),
                &channel.im(row, 0), columns, product_re_.data(), product_im_.data(),
                squares_.data());
  }
  find_ripple(product_re_.data(), product_im_.data(), squares_.data(),
              1.0F / static_cast<float>(2 * reach_),
              static_cast<float>(kLargestDeviation * std::abs(carrier_)), coefficients(ripple_),
              coefficients(power_), columns, &signal.residual(row, 0));
  remove_shading(row, signal);
  const double turn = 2 * carrier_ * static_cast<double>(row);
  for (Demodulated& channel : signal.channels) {
    remove_ripple(product_re_.data(), static_cast<float>(std::cos(turn)),
                  static_cast<float>(std::sin(turn)), columns, &channel.re(row, 0),
                  &channel.im(row, 0));
  }
}

}  // namespace palpate::sensing
