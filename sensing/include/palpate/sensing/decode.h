// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <optional>

#include "palpate/geometry/range_map.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/reason.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"

namespace palpate::sensing {

/// One camera pixel whose depth is known; it stands in for the stripes of a pattern that has none.
struct Anchor {
  double u_px = 0;  ///< column of the frame
  double v_px = 0;  ///< row
  double z = 0;     ///< depth, > 0
};

/// How the phase is divided into smooth regions.
enum class Segmentation {
  flood,  ///< smooth pixels that hang together, cut where stripe edges disagree
  snakes  ///< growing snakes (thesis 3.3.4), which bridge gaps in the borders; slower
};

struct DecodeOptions {
  /// Length of the window that measures the phase, in periods of the sinusoid in the camera's
  /// image: longer is less noisy, shorter sees finer relief and nearer to edges; in [1.25, 8].
  double window_periods = 2;
  /// Decodes the frame brought to half its size (an odd last row or column is left out): several
  /// times faster. The range map and all beside it are of that size, with a camera to match. The
  /// sinusoid must then have at least 3 px a period.
  bool half_resolution = false;
  /// A pixel is lit iff the projector's light >= min_signal of full scale; in (0, 1).
  double min_signal = 0.02;
  /// Its phase counts iff the sinusoid's amplitude >= min_modulation of full scale; in (0, 1) ...
  double min_modulation = 0.01;
  /// ... and amplitude / mean >= min_contrast times that of the pattern; in (0, 1).
  double min_contrast = 0.3;
  /// A stripe edge is where the hue changes by >= min_hue_step a pixel [rad]; in (0, pi).
  double min_hue_step = 0.08;
  /// Its colours are named by so many pixels on each side, fewer where a stripe is narrow; >= 1.
  int color_window_px = 5;
  /// A side is trusted iff the mean probability of its colour >= min_color_score; in (0, 1).
  double min_color_score = 0.7;
  /// Smooth regions hold pixels with a phase variance <= max_phase_variance [rad^2]; > 0.
  double max_phase_variance = 0.01;
  /// They are split where the phase steps by > max_phase_step a pixel [rad]; in (0, pi).
  double max_phase_step = 1.5;
  Segmentation segmentation = Segmentation::flood;
  /// An offset, and the colours around a depth, are accepted iff this share agrees; in (0.5, 1].
  double min_agreement = 0.8;
  /// A depth is kept iff |dz / dphase| <= max_sensitivity * z per rad; > 0.
  double max_sensitivity = 0.1;
  /// For a pattern without stripes, and for no other: the region around it is reconstructed.
  std::optional<Anchor> anchor = {};
};

/// Depths of one frame, and what became of each of its pixels.
struct DecodeResult {
  geometry::RangeMap range;
  ReasonImage reasons;         ///< of the size of the range map: why a pixel has no depth
  geometry::ImageF sigma;      ///< [mm] standard deviation of each depth, NaN where there is none
  int transitions = 0;         ///< stripe edges that were found and named, over all scanlines
  int regions = 0;             ///< smooth regions of the phase
  int unresolved_regions = 0;  ///< regions without enough guesses, or whose guesses disagree
};

/// Turns single frames into depths (thesis 3.3), for one rig, pattern and set of trained colours.
///
/// Differs from the thesis: any pose of the projector (depths are ray-plane intersections; R = I
/// gives Eqs. 3.2 and 3.11), lens distortion of both lenses, complex demodulation, regions grown by
/// phase variance instead of snakes (by default), and a check of every depth against the stripe
/// colour it implies. The constructor prepares what does not depend on the frame; `decode` may run
/// in several threads.
class Decoder {
 public:
  /// \throws InvalidInput if rig or pattern are not valid, an option is outside its range, a colour
  /// of the pattern was never trained, the pattern has neither stripes nor an anchor or both, or
  /// the camera cannot see its sinusoid: the views do not overlap, or a period is below 2 px (3 px
  /// of the half image for `half_resolution`) or above the image.
  Decoder(const Rig& rig, const Pattern& pattern, const TrainedColors& colors,
          const DecodeOptions& options = {});
  ~Decoder();
  Decoder(Decoder&&) noexcept;
  Decoder& operator=(Decoder&&) noexcept;

  /// The rig that the range maps belong to: its camera is of their size.
  [[nodiscard]] const Rig& rig() const;

  /// `frame`: 8 or 16 bit, linear in the light, 1 or 3 channels (BGR), of the camera's size. A
  /// frame without any projector light gives a range map of NaN, not an error.
  /// \throws InvalidInput on a frame of another size or type, or of one channel where the pattern
  /// has coloured stripes.
  [[nodiscard]] DecodeResult decode(const cv::Mat& frame) const;
  /// The same into a result that may hold an earlier frame: its memory is used again, so decoding
  /// one frame after the other allocates next to nothing. Unchanged if an exception is thrown.
  void decode(const cv::Mat& frame, DecodeResult& result) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::sensing
