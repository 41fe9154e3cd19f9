// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <opencv2/core/mat.hpp>
#include <span>

#include "palpate/core/fields.h"
#include "palpate/sensing/decode.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// The meaning, unit and range of each field stand in its list, `visit`.
struct MultishotOptions {
  int exposures = 1;
  double min_signal = 0.01;
  double max_phase_variance = 0.01;
  double max_sensitivity = 0.1;
};

void visit(MultishotOptions& options, FieldVisitor& visitor);

/// Depths of a still scene, and figures that show whether it was still.
struct MultishotResult {
  DecodeResult decoded;  ///< `transitions`, `regions` and `unresolved_regions` are 0
  /// [rad] RMS over the lit pixels of the error of their phases that is not noise: the part of the
  /// images that is not one sinusoid, and that neighbouring pixels share. It comes from motion
  /// between the images, light that flickers, or a response that is not linear. NaN for three
  /// steps, which leave no remainder.
  double disagreement = 0;
  /// Jumps of the phase by whole turns between neighbours along the sinusoid, per turn that it runs
  /// on. A depth step is hardly ever a whole number of turns, but a code of another order is wrong
  /// by whole turns. NaN if no neighbours have phases.
  double code_jumps = 0;
  /// Float in [0, 1], linear in the light, with the channels of the images: the surface under the
  /// mean light of the first exposure, which has no fringes; 0 where the depth is unknown.
  cv::Mat color;
};

/// From this `disagreement` [rad] on, the images do not show one still scene.
inline constexpr double kStillDisagreement = 0.02;
/// From this `code_jumps` on, the images of the code are not those of the pattern, in its order.
inline constexpr double kOrderedCodeJumps = 0.02;

/// Decodes several images of a scene that holds still (`Multishot`) into one range map, pixel by
/// pixel, with the same rig, reasons and depths as `Decoder`.
///
/// Mean, amplitude B and phase of the sinusoid come from least squares over the images, the
/// multiple of 2 pi from the code. The code's bits are read against the mean, and the bit that is
/// least certain, at most one in a Gray code, is read so that it agrees better with the phase. A
/// pixel whose code contradicts its phase gets no depth (`ambiguous_offset`).
///
/// The variance of the phase of N equal steps is 2 sigma_I^2 / (N B^2), where sigma_I^2, the
/// variance of a value, is a linear function of the light: the median over the image of the fit's
/// residuals (with three steps, of fourth differences of the phase between pixels), or the residual
/// of this pixel if that is beyond chance. All channels and exposures are added, after the
/// alignment of red and blue with green.
class MultishotDecoder {
 public:
  /// \throws InvalidInput if rig, pattern or an option is not valid, the pattern is for single
  /// images, the views of camera and projector do not overlap, or the period of the sinusoid in the
  /// camera is below 2 px or larger than the image.
  MultishotDecoder(const Rig& rig, const Pattern& pattern, const MultishotOptions& options = {});
  ~MultishotDecoder();
  MultishotDecoder(MultishotDecoder&&) noexcept;
  MultishotDecoder& operator=(MultishotDecoder&&) noexcept;

  [[nodiscard]] const Rig& rig() const;
  /// Number of images that `decode` takes: those of the pattern, for each exposure.
  [[nodiscard]] int images() const;

  /// Decodes the images of one scene; may be called from several threads.
  /// \param images in the order of `Multishot`, one exposure after the other; 8 or 16 bit, linear in
  /// the light, 1 or 3 channels (BGR; one is used if they are equal), of the camera's size.
  /// \throws InvalidInput if their number, a size or a type is wrong.
  [[nodiscard]] MultishotResult decode(std::span<const cv::Mat> images) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::sensing
