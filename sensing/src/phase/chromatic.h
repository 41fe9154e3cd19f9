// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "image/image_part.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "phase/demodulation.h"
#include "setup/carrier.h"

namespace palpate::sensing {

/// Phase lag of a colour channel behind green as a function of green's projector pixel along the
/// pattern's axis (erratum to Eq. 3.16, for any pose). The channel's panel coordinate is
/// (d - gamma) / beta for green's direction d, so the lag is linear in the pixel.
struct ChromaticLag {
  double slope = 0;   ///< [rad/px]
  double offset = 0;  ///< [rad] at pixel 0

  [[nodiscard]] double at(double pixel) const { return slope * pixel + offset; }
};
[[nodiscard]] ChromaticLag chromatic_lag(const ChromaticShift& shift,
                                         const geometry::Camera& projector, const Pattern& pattern);

/// Values that vary smoothly along the rows are stored at the columns 0, kNodeSpacing,
/// 2 kNodeSpacing, ... up to the last column or beyond, and interpolated linearly in between. The
/// lens shifts are smooth: over 16 pixels they deviate from a straight line by some 1e-4 px.
inline constexpr long kNodeSpacing = 16;
using Nodes = Plane;
[[nodiscard]] Nodes nodes_of(const Plane& smooth);

/// The place in a channel at which it shows the same as green at each pixel of the working image:
/// alpha acts on the normalised camera coordinates (Eq. 3.14). Because the shift varies slowly, the
/// four pixels around that place keep the same distance from the pixel over long runs of a row.
struct ChannelShift {
  /// A range of pixels in a row, and the upper left of the four pixels around the first one's
  /// place.
  struct Run {
    long begin = 0;
    long end = 0;
    long row = 0;
    long column = 0;
  };
  std::vector<std::vector<Run>> runs;  ///< per row; a pixel in no run has no place in the image
  Nodes right;                         ///< [px] horizontally from the pixel to the place
  Nodes down;                          ///< [px] vertically
  Plane turn;                          ///< [rad] phase of the carrier from the place to the pixel
  [[nodiscard]] bool none() const { return runs.empty(); }
};
/// Empty if alpha is one or the image is too small for interpolation.
[[nodiscard]] ChannelShift channel_shift(const geometry::Camera& camera, double alpha,
                                         const Eigen::Matrix2Xd& rays, const Carrier& carrier);

/// The alignment of a channel other than green with green.
struct ChannelModel {
  ChannelShift shift;
  ChromaticLag lag;
  Nodes cosine;  ///< of the lag at each pixel's expected projector pixel, plus the shift's `turn`
  Nodes sine;
};
/// \param expected_pixel as in `ChromaticModel`.
[[nodiscard]] ChannelModel channel_model(ChannelShift shift, const ChromaticLag& lag,
                                         const Plane& expected_pixel);

/// The models of red and blue, and the projector pixels along the axis at which the lags hold.
struct ChromaticModel {
  Plane expected_pixel;
  std::array<ChannelModel, 2> channels;
};
/// The model of a part of the image, without the shifts' turns, which are in its cosines and sines.
/// A pixel whose place is outside the part has none.
[[nodiscard]] ChromaticModel part_of(const ChromaticModel& model, const ImagePart& part);

/// Share of red and of blue in the sum of all channels: Re(channel conj(sum)) / |sum|^2. Empty for
/// frames of one channel.
struct ChannelShares {
  Plane red;
  Plane blue;
};

/// Sum of all channels after alignment with green. Each channel is weighted by its own modulation,
/// so the sum stays valid in stripes that lack a channel.
struct Combined {
  Plane re;
  Plane im;
  ChannelShares shares;
};
/// Aligns and adds the channels. Red and blue are interpolated bilinearly in re and im with the
/// carrier removed, because these vary slowly. The memory of `out` is reused.
void combine_channels(const std::vector<Demodulated>& channels, const ChromaticModel& model,
                      Combined& out);

/// Converts an absolute phase to a projector pixel: (phase + along * row - offset) / per_pixel.
struct PixelOfPhase {
  double along = 0;      ///< [rad/px] carrier frequency down the working image
  double offset = 0;     ///< [rad]
  double per_pixel = 1;  ///< [rad] per projector pixel
  [[nodiscard]] double at(long row, double phase) const {
    return (phase + along * static_cast<double>(row) - offset) / per_pixel;
  }
};

/// Systematic disagreement [rad^2] of red and of blue with green that remains after the chromatic
/// model: the mean product of the phase differences at two pixels of a row that are far enough
/// apart for independent noise. Zero where too few pixels show both channels.
struct ChromaticError {
  double red = 0;
  double blue = 0;
};
/// Tells whether texture disturbs the phases of the channels, as in a single image: products beyond
/// ten times their median are then cut there, so that a few edges do not count for the whole frame.
enum class PhaseTexture : std::uint8_t { none, disturbs };
/// \param phase [rad] absolute, of the working image; NaN where unknown.
[[nodiscard]] ChromaticError remaining_error(const std::vector<Demodulated>& channels,
                                             const ChromaticModel& model, const Plane& phase,
                                             const PixelOfPhase& pixels, PhaseTexture texture);

}  // namespace palpate::sensing
