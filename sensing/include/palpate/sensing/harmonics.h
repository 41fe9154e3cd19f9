// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>
#include <optional>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

struct HarmonicOptions {
  double min_modulation = 0.02;  ///< use a window if amplitude >= min_modulation of full scale ...
  double max_misfit = 0.25;      ///< ... and RMS misfit <= max_misfit * amplitude; > 0
  /// The sinusoid is reported as distorted if a harmonic is >= max_ratio of the fundamental and
  /// >= 4 of its own standard deviations; in (0, 1).
  double max_ratio = 0.02;
};

/// A harmonic relative to the fundamental.
struct Harmonic {
  double ratio = 0;  ///< of the amplitudes; > 0 if it sharpens the crests, < 0 if it flattens them
  double deviation = 0;  ///< standard deviation of the ratio
};

/// Harmonic distortion of a sinusoid that has passed through projector, surface and camera.
struct HarmonicCheck {
  double period = 0;      ///< camera px, median
  bool along_x = false;   ///< true if the sinusoid varies along the image rows
  double modulation = 0;  ///< amplitude / mean, median
  /// Not set if the harmonic cannot be measured: if the period is short, or close to the period
  /// (6 px for the second harmonic, 8 px for the third) at which an alias of the fundamental,
  /// caused by a colour mosaic, coincides with the harmonic.
  std::optional<Harmonic> second{};
  std::optional<Harmonic> third{};
  long places = 0;  ///< number of windows used
  /// RMS phase error [rad] that the harmonics cause in a demodulator of fixed frequency whose Hann
  /// window is two median periods long. The zeros of its spectrum suppress the harmonics only where
  /// the local period equals the median.
  double phase_wave = 0;
  bool distorted = false;
};

/// Measures the second and third harmonic in an image of a white sinusoid. Harmonics are the most
/// common cause of waves in depth maps (thesis 3.4.1).
///
/// In windows of about three periods, along the direction with the more periodic variation, a
/// least-squares fit finds mean, slope, fundamental and two harmonics at the local frequency. A
/// nonlinear response keeps harmonics in phase with the fundamental, so the in-phase parts are
/// averaged over all windows; noise, texture and slopes average out. The deviations come from the
/// scatter between windows.
/// \param frame 8 or 16 bit, 1 or 3 channels; the channel with the largest mean is used.
/// \throws InvalidInput if the type is wrong, an option is outside its range, or too few windows
/// show a sinusoid whose harmonics can be measured.
[[nodiscard]] HarmonicCheck check_harmonics(const cv::Mat& frame,
                                            const HarmonicOptions& options = {});

/// Computes |dz / dphase| [mm/rad] at depth z [mm] in the middle of the camera's image.
/// \throws InvalidInput unless z > 0, rig and pattern are valid, and the projector reaches this
/// place.
[[nodiscard]] double depth_per_radian(const Rig& rig, const Pattern& pattern, double z);

}  // namespace palpate::sensing
