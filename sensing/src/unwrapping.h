// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <vector>

#include "planes.h"

namespace palpate::sensing {

using Labels = Eigen::Array<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// What a region may go through.
struct FloodLimits {
  double max_variance = 0;  ///< pixels with at most this phase variance [rad^2]
  double max_step = 0;      ///< steps of the phase of at most this [rad], < pi
};

/// Smooth regions of the phase, each unwrapped up to a multiple of 2 pi of its own.
struct Regions {
  Labels label;  ///< 0 ... count - 1, or -1
  Plane phase;   ///< [rad] unwrapped; of no meaning where the label is -1
  int count = 0;
};

/// Grows regions from the smoothest pixel that belongs to none yet, always on to the smoothest
/// pixel at the border (thesis 3.3.5), within the limits.
/// \param wrapped phase [rad]; pixels outside the mask have infinite variance.
[[nodiscard]] Regions grow_regions(const Plane& wrapped, const Plane& variance,
                                   const FloodLimits& limits);

/// A place in a region where the multiple of 2 pi is known that its unwrapped phase lacks.
struct Marker {
  int pixel = 0;  ///< row * columns + column, in a region
  int turns = 0;
};

/// Splits the regions whose markers disagree: where two surfaces meet at a depth step of about a
/// whole period, the phase alone shows no border. Floods such a region from all its markers at
/// once, in the order of variance, so that the parts meet where the phase is least smooth; parts of
/// one region with the same number of turns share a label. The limits are those the regions were
/// grown with.
void split_regions(const Plane& wrapped, const Plane& variance, const FloodLimits& limits,
                   const std::vector<Marker>& markers, Regions& regions);

/// Markers of unknown turns (each core has a number of its own) on every pixel of the cores in
/// which no marker lies: a core is what hangs together of the regions once all necks narrower than
/// seven pixels are cut, and is large enough for a stripe edge to be expected in it. The part of a
/// region behind such a neck may be another surface; without a stripe edge of its own its depth
/// must stay unknown.
[[nodiscard]] std::vector<Marker> mark_unproven_cores(const Plane& wrapped, const Plane& variance,
                                                      const FloodLimits& limits,
                                                      const std::vector<Marker>& markers);

}  // namespace palpate::sensing
