// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>

#include "palpate/core/fields.h"
#include "palpate/sensing/image_size.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/trained_colors.h"

namespace palpate::sensing {

/// Range of the depths of the objects to be measured, along the camera's optical axis [mm].
struct WorkingRange {
  double near = 0;  ///< > 0
  double far = 0;   ///< >= near
};

/// `visit` describes the fields.
struct PatternOptions {
  int number_of_colors = 6;
  std::optional<int> stripes = {};
  /// Trained hues, if any: the colours are chosen so that the camera distinguishes them best.
  std::optional<TrainedColors> trained = {};
  std::optional<Axis> axis = {};
  /// Default: the depth around which the views of camera and projector overlap.
  std::optional<WorkingRange> range = {};
  /// A Bayer mosaic samples red and blue at every second pixel (minimum 4), and a slope towards the
  /// projector shortens the period by up to a third (minimum 6). At 7 px a lens blur of 1 px keeps
  /// two thirds of the amplitude. Precision falls in proportion to the period.
  double min_camera_period = 7;
  /// The default keeps 90 % of the amplitude if the projector's pixels and lens blur as much as a
  /// square of two pixels.
  double min_projector_period = 8;
  std::optional<double> period = {};
  /// v = mean + amplitude cos(...), within [0, 1].
  std::optional<double> mean = {}, amplitude = {};
};

void visit(PatternOptions& options, FieldVisitor& visitor);

/// A pattern and its predicted properties. Without a rig the last three values are 0.
struct PatternDesign {
  Pattern pattern;
  double largest_overlap = 0;  ///< predicted from the trained hues (`largest_overlap`); else 0
  double camera_period = 0;    ///< shortest in the camera [px], on surfaces that face it
  /// Depth times the derivative of the phase by depth [rad], at the image centre and mid-range: the
  /// relative depth error is the phase error divided by this.
  double phase_per_relative_depth = 0;
  /// Largest error of a stripe edge's position [camera px] that still identifies the right period.
  /// Below about 2 px the stripes do not identify periods reliably.
  double edge_tolerance = 0;
};

/// Designs a pattern (thesis 3.2, 3.3) for a rig.
///
/// The period is the shortest that satisfies the limits of the camera's and the projector's pixels
/// (3.3.3), rounded up to whole projector pixels so that every period is sampled alike. Stripes of
/// equal width fill the panel; their edges lie between pixels.
/// \throws InvalidInput if the rig or an option is not valid, a stripe would be narrower than 4
/// projector pixels, the panel is shorter than one period, the projector lights nothing that the
/// camera sees in the range, or the range is so far away that the phase does not depend on depth.
[[nodiscard]] PatternDesign design_pattern(const Rig& rig, const PatternOptions& options = {});

/// The same for a projector of which only the size is known. The period is the option `period`, or
/// the larger of 10 and min_projector_period.
/// \throws InvalidInput as above, or if a size is not > 0.
[[nodiscard]] PatternDesign design_pattern(int projector_width, int projector_height,
                                           const PatternOptions& options = {});

/// Makes the pattern for several images of a still scene (`Multishot`): `steps` equally spaced
/// shifts, and a code with cells of half a period that covers the panel. Axis, period, phase, mean
/// and amplitude are those of `single`; its stripes are left out.
///
/// Steps of a turn / N keep the harmonics 2 to N - 2 of a response that is not linear out of the
/// phase; noise falls with sqrt(N).
/// \throws InvalidInput if `single` is not valid, unless 3 <= steps <= 64, or if the panel has more
/// than 2^15 periods.
[[nodiscard]] Pattern multishot_pattern(const Pattern& single, int steps, const ImageSize& panel);

}  // namespace palpate::sensing
