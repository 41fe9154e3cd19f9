// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "image/image_plane.h"

namespace palpate::sensing {

/// A window over a column and the sinusoid that is sought in it.
struct DemodulationFilter {
  int radius = 0;      ///< px; the window holds 2 radius + 1 pixels
  double carrier = 0;  ///< [rad/px]
  std::vector<float>
      weight;  ///< of the pixel k rows away, k = 0 ... radius; the whole window sums to 1
  /// Binomial averages along the rows, the pixels of each twice as far apart as those before.
  int averages = 1;

  /// Pixels of a row that an average holds.
  [[nodiscard]] int width() const { return 4 * ((1 << averages) - 1) + 1; }
};

/// A Hann window so many periods long. Of two: light that does not vary, and the second harmonic of
/// the sinusoid, fall on zeros of its spectrum. Along the rows it averages over as much of a period
/// as five pixels are at 7 px: the most that a period holds, at least five pixels.
[[nodiscard]] DemodulationFilter make_filter(double carrier, double periods = 2);

/// The sinusoid found around each pixel: v(row + k) = mean + Re(2 (re + i im) exp(i carrier (row +
/// k))). What is not known is zero.
struct Demodulated {
  Plane re;
  Plane im;
  Plane mean;
};

struct Demodulation {
  std::vector<Demodulated> channels;
  /// Mean square of what mean and sinusoid leave in the window, fraction of full scale squared, the
  /// sum of all channels: noise, texture, steps, a frequency off the carrier.
  Plane residual;
};

/// Weighted least squares of mean and sinusoid in the window around each pixel of the mask, from
/// pixels of the mask alone (thesis 3.3.3, in its complex form). Away from the mask's borders that
/// is multiplication by exp(-i carrier row) and a low-pass; at the borders it keeps the step of
/// brightness out of the phase. Then re, im and the residual are averaged along the rows with
/// binomial weights, those outside the mask being zero. Memory of `out` is used again.
void demodulate(const std::vector<Plane>& channels, const Mask& mask,
                const DemodulationFilter& filter, Demodulation& out);

}  // namespace palpate::sensing
