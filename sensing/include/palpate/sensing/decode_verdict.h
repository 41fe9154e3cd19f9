// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>

namespace palpate::sensing {

/// Possible explanations of frames that contradict rig, pattern or colours.
enum class FrameExplanation {
  red_blue_swapped,
  red_green_swapped,
  green_blue_swapped,
  negative,          ///< bright where it should be dark
  stripes_reversed,  ///< the pattern's stripes are projected in reverse order
  mirrored,          ///< left and right of the image are exchanged
  flipped,           ///< top and bottom of the image are exchanged
  rotated,           ///< both
};
inline constexpr int kFrameExplanations = 8;

/// Bands of rows of a frame that are judged one by one.
inline constexpr int kRowBands = 12;

/// Sums over stripe edges that show whether their shift against the sinusoid depends on the depth.
struct DepthTrend {
  long edges = 0;
  double disparity = 0;  ///< [px] shift of an edge in the image by its depth, relative to infinity
  double disparity_squares = 0;  ///< [px^2]
  double shift = 0;              ///< [px] of the edge against the sinusoid
  double products = 0;           ///< [px^2] of disparity and shift

  DepthTrend& operator+=(const DepthTrend& other);
};

/// Agreement of the stripes of frames with their sinusoid, which are independent measurements of
/// the same depths: sums over frames, so that `+=` combines a sequence.
///
/// A stripe edge gives a depth, and this a phase of the sinusoid; the measured phase differs from
/// it by d periods, of which whole ones do not count. With the right rig, pattern and colours d is
/// close to zero everywhere. Stripe edges one side of which has none of the trained hues are left
/// out, because coloured surfaces show them.
struct DecodeEvidence {
  long edges = 0;         ///< stripe edges that were compared with the phase, on some scanlines
  long off_panel = 0;     ///< further ones, which the projector cannot light where they are seen
  long stripe_edges = 0;  ///< different edges of the pattern among them, added up over the frames
  double agreement = 0;   ///< sum of cos(2 pi d)
  double shift = 0;       ///< sum of sin(2 pi d)
  /// Those in parts of the frame in which d is about the same, for each band of rows, from the top.
  std::array<long, kRowBands> steady_edges{};
  /// Those in such parts where d is, on average, more than an edge can be displaced by blur and by
  /// the colours of a lens.
  std::array<long, kRowBands> displaced_edges{};
  long rows = 0;  ///< of a frame
  DepthTrend trend = {};
  long neighbours = 0;    ///< pairs of successive edges of a scanline
  double smoothness = 0;  ///< sum of cos(2 pi (difference of d)) over these
  /// Sums of cos(2 pi d) as if an explanation held; only of frames that disagree.
  std::array<double, kFrameExplanations> explained{};
  long explained_edges = 0;       ///< `edges` plus `off_panel` of these frames
  std::array<double, 3> light{};  ///< sums of the sinusoid's amplitude in red, green, blue
  long lit = 0;                   ///< lit pixels that were examined
  long hues = 0;                  ///< those with a sinusoid
  /// Those with a sinusoid across the expected direction; only of frames with few edges.
  long across = 0;
  long trained_hues = 0;           ///< those with a sinusoid and the hue of a trained colour
  double steps_in_pairs = 0;       ///< squared differences of rows 0 and 1, 2 and 3, ...
  double steps_between_pairs = 0;  ///< and of rows 1 and 2, 3 and 4, ...
  bool colors_fit_pattern = true;  ///< the trained hues are those of the pattern's colours

  DecodeEvidence& operator+=(const DecodeEvidence& other);
};

enum class DecodeVerdict {
  accepted,
  too_little,        ///< few stripe edges, or a coloured surface: no judgement is possible
  wrong_channels,    ///< colour channels are exchanged, or the frames are negatives
  wrong_colors,      ///< the trained colours are those of another camera or projector
  turned_frames,     ///< the frames are mirrored, flipped or rotated
  wrong_rows,        ///< rows of the frames are exchanged or doubled
  torn_frames,       ///< some rows do not fit, although the others do
  reversed_stripes,  ///< the stripes of the pattern are in reverse order
  shifted_sinusoid,  ///< the sinusoid is shifted against the stripes, everywhere alike
  wrong_rig,         ///< the shift varies smoothly over the frame, or with the depth
  wrong_pattern      ///< stripes and sinusoid have nothing to do with each other
};

struct DecodeJudgement {
  DecodeVerdict verdict = DecodeVerdict::too_little;
  std::string reason;  ///< the verdict in a sentence, with figures and what to try
  /// Returns true if there is no evidence against the depths: `accepted` or `too_little`.
  [[nodiscard]] bool usable() const {
    return verdict == DecodeVerdict::accepted || verdict == DecodeVerdict::too_little;
  }
};

/// Judges whether frames fit the rig, the pattern and the trained colours with which they were
/// decoded. If they do not, depths are wrong as a whole, and by more than their predicted
/// deviations. Errors that leave stripes and sinusoid in agreement are not detected: a baseline
/// that is too long or too short as a whole, which scales all depths, or, for a surface at one
/// depth, a shift by whole periods, also of a torn part of the frame.
[[nodiscard]] DecodeJudgement judge(const DecodeEvidence& evidence);

/// Name of a verdict as in the enumeration.
[[nodiscard]] const char* to_string(DecodeVerdict verdict);

}  // namespace palpate::sensing
