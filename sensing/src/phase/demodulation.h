// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <numbers>
#include <vector>

#include "image/image_plane.h"

namespace palpate::sensing {

/// A window over a column and the frequency of the sinusoid to be fitted in it.
struct DemodulationFilter {
  int radius = 0;      ///< px; the window holds 2 radius + 1 pixels
  double carrier = 0;  ///< [rad/px]
  std::vector<float>
      weight;  ///< of the pixel k rows away, k = 0 ... radius; the whole window sums to 1
  /// Number of binomial averages along the rows; each doubles the pixel spacing of the one before.
  int averages = 1;

  /// Period of the carrier [px].
  [[nodiscard]] double period() const { return 2 * std::numbers::pi / std::abs(carrier); }
  /// Number of pixels of a row that the averages cover.
  [[nodiscard]] int width() const { return 4 * ((1 << averages) - 1) + 1; }
  /// [px^2] Variances of the weights along the rows and down the window: binomial means of five
  /// pixels that are 1, 2, 4, ... px apart have variances of 1, 4, 16, ... px^2.
  [[nodiscard]] double row_variance() const { return ((1 << 2 * averages) - 1) / 3.0; }
  [[nodiscard]] double window_variance() const;
};

/// Makes a Hann window of a number of periods. With two periods, constant light and the second
/// harmonic of the sinusoid lie on zeros of its spectrum. Along the rows the filter averages over
/// the same part of a period as five pixels at 7 px per period, and over five pixels at least.
[[nodiscard]] DemodulationFilter make_filter(double carrier, double periods = 2);

/// Sinusoid around each pixel: v(row + k) = mean + Re(2 (re + i im) exp(i carrier (row + k))). Zero
/// where unknown.
struct Demodulated {
  Plane re;
  Plane im;
  Plane mean;

  /// Square of half the amplitude at a pixel.
  [[nodiscard]] float power(long row, long column) const {
    return re(row, column) * re(row, column) + im(row, column) * im(row, column);
  }
};

struct Demodulation {
  std::vector<Demodulated> channels;
  /// Mean square of the fit's residual in the window, in (fraction of full scale)^2, summed over
  /// all channels: noise, texture, steps, or a frequency other than the carrier.
  Plane residual;
};

/// Fits mean and sinusoid by weighted least squares in the window around each pixel of the mask,
/// using only pixels of the mask (thesis 3.3.3, in complex form).
///
/// Away from the mask's border this is multiplication by exp(-i carrier row) followed by a low-pass
/// filter; at the border it keeps the step of brightness out of the phase. Then re, im and the
/// residual are averaged along the rows with binomial weights, with zeros outside the mask. The
/// memory of `out` is reused.
void demodulate(const std::vector<Plane>& channels, const Mask& mask,
                const DemodulationFilter& filter, Demodulation& out);

}  // namespace palpate::sensing
