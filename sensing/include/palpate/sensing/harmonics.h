// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

struct HarmonicOptions {
  double min_modulation = 0.02;  ///< a place counts iff amplitude >= min_modulation of full scale
  double max_misfit = 0.25;      ///< and RMS misfit <= max_misfit * amplitude; > 0
  /// The sinusoid counts as distorted iff a harmonic is >= max_ratio of it and >= 4 of its standard
  /// deviations; in (0, 1).
  double max_ratio = 0.02;
};

/// One harmonic, relative to the sinusoid.
struct Harmonic {
  double ratio = 0;      ///< of its amplitude; < 0 if it dents the crests rather than sharpens them
  double deviation = 0;  ///< standard deviation of the ratio
};

/// What is left of a sinusoid after projector, surface and camera.
struct HarmonicCheck {
  double period = 0;      ///< camera px, median
  bool along_x = false;   ///< whether it varies along the image rows
  double modulation = 0;  ///< amplitude / mean, median
  /// Deviation infinite, ratio 0 if not known: where the period is short, or near the one (6 px for
  /// the second, 8 px for the third) at which what a colour mosaic leaves of the sinusoid lies on
  /// the harmonic.
  Harmonic second;
  Harmonic third;
  long places = 0;  ///< windows that count
  /// RMS of the wave in the phase [rad] that the harmonics cause in a demodulator of fixed
  /// frequency whose Hann window is two median periods long; the harmonics fall on zeros of its
  /// spectrum only where the local period is the median one.
  double phase_wave = 0;
  bool distorted = false;
};

/// Looks for the second and third harmonic in one image of a white sinusoid (thesis 3.4.1: the
/// commonest cause of waves in depth maps).
///
/// In windows of about three periods, along the direction in which the image varies more
/// periodically, mean, slope, fundamental and two harmonics are fitted by least squares at the
/// local frequency. A distortion of brightness keeps the crests of all harmonics together, so what
/// is counted is their part in phase with the fundamental, averaged over all windows: noise,
/// texture and slopes, which have no such phase, average out. The deviations come from the scatter
/// of the windows. \param frame 8 or 16 bit, 1 channel or 3; the channel with the largest mean is
/// looked at. \throws InvalidInput on another type, an option outside its range, or if too few
/// places show a sinusoid of which a harmonic can be known.
[[nodiscard]] HarmonicCheck check_harmonics(const cv::Mat& frame,
                                            const HarmonicOptions& options = {});

/// |dz / dphase| [mm/rad] at depth z [mm] in the middle of the camera's image.
/// \throws InvalidInput unless z > 0, the rig and pattern are valid and the projector reaches
/// there.
[[nodiscard]] double depth_per_radian(const Rig& rig, const Pattern& pattern, double z);

}  // namespace palpate::sensing
