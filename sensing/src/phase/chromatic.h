// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "phase/demodulation.h"
#include "setup/carrier.h"

namespace palpate::sensing {

/// By how much the phase of a colour channel lags behind green's, as a function of green's
/// projector pixel along the pattern's axis (erratum to Eq. 3.16, for any pose): the channel's
/// panel coordinate is (d - gamma) / beta where d is green's direction, so the lag is linear in the
/// pixel.
struct ChromaticLag {
  double slope = 0;   ///< [rad/px]
  double offset = 0;  ///< [rad] at pixel 0

  [[nodiscard]] double at(double pixel) const { return slope * pixel + offset; }
};
[[nodiscard]] ChromaticLag chromatic_lag(const ChromaticShift& shift,
                                         const geometry::Camera& projector, const Pattern& pattern);

/// What varies smoothly along the rows is kept at the columns 0, kNodeSpacing, 2 kNodeSpacing, ...
/// up to one that is not left of the last column; between, it is linear. Smooth are the lenses:
/// over 16 pixels a place bends away from its chord by some 1e-4 px.
inline constexpr long kNodeSpacing = 16;
using Nodes = Plane;
[[nodiscard]] Nodes nodes_of(const Plane& smooth);

/// Where a channel shows what green shows at each pixel of the working image: alpha acts on the
/// normalised camera coordinates (Eq. 3.14). The shift varies slowly, so the four pixels around
/// such a place are the same number of pixels away over long runs of a row.
struct ChannelShift {
  /// Pixels of a row, and the upper left of the four around the place that belongs to the first.
  struct Run {
    long begin = 0;
    long end = 0;
    long row = 0;
    long column = 0;
  };
  std::vector<std::vector<Run>> runs;  ///< of each row; a pixel in none is outside the image
  Nodes right;                         ///< [px] from the pixel to the place
  Nodes down;                          ///< [px]
  Plane turn;                          ///< [rad] of the carrier from the place to the pixel
  [[nodiscard]] bool none() const { return runs.empty(); }
};
/// Nothing if alpha is one, or the image too small to interpolate in.
[[nodiscard]] ChannelShift channel_shift(const geometry::Camera& camera, double alpha,
                                         const Eigen::Matrix2Xd& rays, const Carrier& carrier);

/// How a channel other than green is brought to green.
struct ChannelModel {
  ChannelShift shift;
  ChromaticLag lag;
  Nodes cosine;  ///< of the lag at each pixel's expected projector pixel, plus the shift's turn
  Nodes sine;
};
/// \param expected_pixel as in `ChromaticModel`.
[[nodiscard]] ChannelModel channel_model(ChannelShift shift, const ChromaticLag& lag,
                                         const Plane& expected_pixel);

/// Red and blue, and the projector pixel along the axis at which their lags were taken.
struct ChromaticModel {
  Plane expected_pixel;
  std::array<ChannelModel, 2> channels;
};

/// What part of the sum of all channels comes from red and from blue: Re(channel conj(sum)) /
/// |sum|^2. Nothing in a frame of one channel.
struct ChannelShares {
  Plane red;
  Plane blue;
};

/// The sinusoid of all channels as green sees it. Each is weighted by its own modulation, so a
/// stripe that lacks a channel lacks nothing else.
struct Combined {
  Plane re;
  Plane im;
  ChannelShares shares;
};
/// Red and blue are interpolated bilinearly in re and im, which vary slowly, the carrier being
/// taken out and put back. Memory of `out` is used again.
void combine_channels(const std::vector<Demodulated>& channels, const ChromaticModel& model,
                      Combined& out);

/// The projector pixel that an absolute phase means: (phase + along * row - offset) / per_pixel.
struct PixelOfPhase {
  double along = 0;      ///< [rad/px] carrier down the working image
  double offset = 0;     ///< [rad]
  double per_pixel = 1;  ///< [rad/px] of the projector
  [[nodiscard]] double at(long row, double phase) const {
    return (phase + along * static_cast<double>(row) - offset) / per_pixel;
  }
};

/// Systematic disagreement of red and of blue with green that the chromatic model leaves [rad^2]:
/// the mean product of the phase differences at two pixels of a row, far enough apart for their
/// noise to be independent. Zero where too few pixels show both channels.
struct ChromaticError {
  double red = 0;
  double blue = 0;
};
/// \param phase [rad] absolute, of the working image; NaN where unknown.
[[nodiscard]] ChromaticError remaining_error(const std::vector<Demodulated>& channels,
                                             const ChromaticModel& model, const Plane& phase,
                                             const PixelOfPhase& pixels);

}  // namespace palpate::sensing
