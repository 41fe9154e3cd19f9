// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/geometry/range_map.h"
#include "palpate/sensing/decode_verdict.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/reason.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"

namespace palpate::sensing {

/// A camera pixel of known depth; it replaces the stripes for a pattern that has none.
struct Anchor {
  double u_px = 0;  ///< column in the frame
  double v_px = 0;  ///< row in the frame
  double z = 0;     ///< [mm] depth, > 0
};

/// Method that divides the phase image into smooth regions.
enum class Segmentation {
  flood,  ///< connected smooth pixels, cut where stripe edges disagree
  snakes  ///< growing snakes (thesis 3.3.4), which bridge gaps in region borders; slower
};

/// The meaning, unit and range of each field are in its list, `visit`, which docs/options.md
/// shows.
struct DecodeOptions {
  double window_periods = 2;
  bool half_resolution = false;
  double min_signal = 0.02;
  double min_modulation = 0.01;
  double max_phase_sigma = 0.25;
  double min_hue_step = 0.08;
  int color_window_px = 5;
  double min_color_score = 0.7;
  double max_phase_variance = 0.01;
  double max_phase_step = 1.5;
  Segmentation segmentation = Segmentation::flood;
  double min_agreement = 0.8;
  double max_sensitivity = 0.1;
  std::vector<Anchor> anchors = {};
};

void visit(DecodeOptions& options, FieldVisitor& visitor);

/// Depths of a frame, and the outcome of each pixel.
struct DecodeResult {
  geometry::RangeMap range;
  ReasonImage reasons;     ///< same size as the range map: why a pixel has no depth
  geometry::ImageF sigma;  ///< [mm] standard deviation of each depth, NaN where there is none
  /// [mm] the part of `sigma` that differs from pixel to pixel, the noise of the frame. The rest,
  /// from `Rig::covariance`, bends and scales the surface as a whole. Empty if the rig has no
  /// covariance: `sigma` then is the noise alone.
  geometry::ImageF noise;
  int transitions = 0;         ///< number of stripe edges identified, over all scanlines
  int regions = 0;             ///< number of smooth regions of the phase
  int unresolved_regions = 0;  ///< regions with too few stripe edges, or contradicting ones
  /// Evidence of whether the frame fits rig, pattern and colours at all: pass it, or the sum of a
  /// sequence, to `judge` before you use the depths. Empty for a pattern without stripes.
  DecodeEvidence evidence = {};
};

/// Decodes single frames into range maps (thesis 3.3), for one rig, pattern and set of trained
/// colours. The constructor prepares everything that does not depend on the frame; `decode` may be
/// called from several threads.
///
/// Differences from the thesis: the projector may have any pose (depths are ray-plane
/// intersections; R = I gives Eqs. 3.2 and 3.11), both lenses may have distortion, demodulation is
/// complex, regions grow by phase variance instead of snakes (by default), and every depth is
/// checked against the stripe colour it implies.
class Decoder {
 public:
  /// \throws InvalidInput if rig or pattern are not valid, an option is outside its range, a colour
  /// of the pattern was not trained, the pattern has both stripes and anchors or neither, the
  /// views of camera and projector do not overlap, or the period of the sinusoid in the camera is
  /// below 2 px (for `half_resolution`, 3 px of the half image) or larger than the image.
  Decoder(const Rig& rig, const Pattern& pattern, const TrainedColors& colors,
          const DecodeOptions& options = {});
  ~Decoder();
  Decoder(Decoder&&) noexcept;
  Decoder& operator=(Decoder&&) noexcept;

  /// The rig of the range maps; its camera has their size.
  [[nodiscard]] const Rig& rig() const;

  /// Decodes a frame. A frame without projector light gives a range map of NaN, not an error.
  /// \param frame 8 or 16 bit, linear in the light, 1 or 3 channels (BGR), of the camera's size.
  /// \throws InvalidInput if the frame has another size or type, or has one channel although the
  /// pattern has coloured stripes, or if two anchors contradict each other on one smooth surface.
  [[nodiscard]] DecodeResult decode(const cv::Mat& frame) const;
  /// The same, reusing the memory of an earlier result: decoding one frame after another hardly
  /// allocates any memory. `result` is unchanged if an exception is thrown.
  void decode(const cv::Mat& frame, DecodeResult& result) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::sensing
