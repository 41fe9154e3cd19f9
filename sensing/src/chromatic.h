// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <vector>

#include "carrier.h"
#include "demodulation.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

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

/// Where a channel shows what green shows at each pixel: alpha acts on the normalised camera
/// coordinates (Eq. 3.14). Shapes as the working image.
struct ChannelShift {
  Plane columns;  ///< px, to be added to green's column
  Plane rows;     ///< px
  Plane cosine;   ///< of the carrier over `rows`
  Plane sine;
  [[nodiscard]] bool none() const { return columns.size() == 0; }
};
/// Nothing if alpha is one, or the image too small to interpolate in.
[[nodiscard]] ChannelShift channel_shift(const geometry::Camera& camera, double alpha,
                                         const Eigen::Matrix2Xd& rays, const Carrier& carrier);

/// The channel's signal where green sees it: bilinear on re and im, which vary slowly, the carrier
/// being taken out and put back.
[[nodiscard]] Demodulated resample(const Demodulated& signal, const ChannelShift& shift);

/// How a channel other than green is brought to green.
struct ChannelModel {
  ChannelShift shift;
  ChromaticLag lag;
  Plane cosine;  ///< of the lag at each pixel's expected projector pixel
  Plane sine;
};

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
[[nodiscard]] Combined combine_channels(const std::vector<Demodulated>& channels,
                                        const ChromaticModel& model);

}  // namespace palpate::sensing
