// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"

namespace palpate::sensing {

/// Depths of the objects that will be measured, along the camera's optical axis [mm].
struct WorkingRange {
  double near = 0;  ///< > 0
  double far = 0;   ///< >= near
};

struct PatternOptions {
  int colors = 6;   ///< number of stripe colours; in [2, 24]
  int stripes = 0;  ///< their number, 2 to colors (colors - 1) + 1; 0 for the most
  /// Hues as trained before: the colours are spread so that the camera tells them apart best.
  std::optional<TrainedColors> trained = {};
  /// Along which the sinusoid varies; nothing: along which the projector pixel depends more on the
  /// depth (y if both do alike or there is no rig).
  std::optional<Axis> axis = {};
  /// Nothing: the depth about which the views of camera and projector overlap.
  std::optional<WorkingRange> range = {};
  /// The sinusoid's period in the camera is >= min_camera_period everywhere on surfaces that face
  /// it within the range; >= 2 (Nyquist). The default leaves room for what makes the limit worse: a
  /// Bayer mosaic samples red and blue at every second pixel (4), a slope that faces the projector
  /// shortens the period by up to a third (6), and of a lens's blur of 1 px the sinusoid of 7 px
  /// keeps two thirds of its amplitude; longer periods are the less precise in proportion.
  double min_camera_period = 7;
  /// And in the projector >= min_projector_period; >= 2. The default keeps 90 % of the amplitude
  /// when the projector's pixels and lens blur as much as a square of two pixels.
  double min_projector_period = 8;
  /// Taken instead of the choice from these limits, if given [projector px]; >= 2.
  std::optional<double> period = {};
  /// v = mean + amplitude cos(...), as large as v <= 1 allows, but for what the troughs need in
  /// order to show the stripes' hue.
  double mean = 0.575;
  double amplitude = 0.425;  ///< > 0; mean +- amplitude within [0, 1]
};

/// A pattern and what it leads to. Without a rig the last three are 0.
struct PatternDesign {
  Pattern pattern;
  double largest_overlap = 0;  ///< predicted of the trained hues (`largest_overlap`); else 0
  double camera_period = 0;    ///< shortest in the camera [px], on surfaces that face it
  /// Phase per depth, times the depth [rad], in the middle of the image and of the range: the
  /// relative depth error is the phase error divided by this.
  double phase_per_relative_depth = 0;
  /// By how much a stripe edge may be misplaced [camera px] before the period it tells is a wrong
  /// one. Below about 2 the stripes do not reliably tell one period from the next.
  double edge_tolerance = 0;
};

/// Designs a pattern (thesis 3.2, 3.3) for a rig: the shorter of the limits that the pixels of
/// camera and projector set (3.3.3) decides the period, rounded up to whole projector pixels so
/// that every period is sampled alike; stripes of equal width fill the panel, their edges lying
/// between pixels.
/// \throws InvalidInput if the rig or an option is not valid, a stripe would be narrower than 4
/// projector pixels, the panel does not hold a period, the projector lights nothing of what the
/// camera sees in the range, or the range is too far for the phase to depend on the depth.
[[nodiscard]] PatternDesign design_pattern(const Rig& rig, const PatternOptions& options = {});

/// The same for a projector of which only the size is known: the period is the option's, or the
/// longer of 10 and min_projector_period.
/// \throws InvalidInput as above, or if the sizes are not > 0.
[[nodiscard]] PatternDesign design_pattern(int projector_width, int projector_height,
                                           const PatternOptions& options = {});

}  // namespace palpate::sensing
