// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "image/image_plane.h"
#include "regions/smooth_runs.h"
#include "regions/variance_queue.h"

namespace palpate::sensing {

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

/// A place in a region where the multiple of 2 pi is known that its unwrapped phase lacks.
struct Marker {
  int pixel = 0;  ///< row * columns + column, in a region
  int turns = 0;
};

/// Memory that the functions below use again from frame to frame; it says nothing between calls.
struct UnwrappingBuffers {
  SmoothRuns runs;
  Mask classes;
  Mask row_minima;
  Labels cores;
  std::vector<SmoothRuns::Extent> core_extents;
  std::vector<int> core_parts;
  Mask ranks;
  Mask roles;
  VarianceQueue queue;
};

/// Finds the smooth regions within the limits and unwraps each in order of quality (thesis 3.3.5).
/// \param wrapped phase [rad]; pixels outside the mask have infinite variance.
void grow_regions(const Plane& wrapped, const Plane& variance, const FloodLimits& limits,
                  UnwrappingBuffers& buffers, Regions& regions);

/// Splits the regions whose markers disagree: where two surfaces meet at a depth step of about a
/// whole period, the phase alone shows no border. The limits are those the regions were grown with.
///
/// A core is what hangs together of the regions once all necks narrower than seven pixels are cut.
/// The part of a region behind such a neck may be another surface: a core without a marker, large
/// enough for a stripe edge to be expected in it, becomes a region of its own, whose depth must
/// stay unknown. A core whose markers agree stays whole. The rest is
/// flooded from these cores, and from the markers elsewhere, in the order of variance, so that the
/// parts meet where the phase is least smooth. Parts of one region with the same number of turns
/// share a label.
void split_regions(const Plane& wrapped, const Plane& variance, const FloodLimits& limits,
                   const std::vector<Marker>& markers, UnwrappingBuffers& buffers,
                   Regions& regions);

}  // namespace palpate::sensing
