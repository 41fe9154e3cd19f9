// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <vector>

#include "image/image_plane.h"
#include "regions/smooth_runs.h"
#include "regions/variance_queue.h"

namespace palpate::sensing {

/// Limits within which a region grows.
struct FloodLimits {
  double max_variance = 0;  ///< largest phase variance of a pixel [rad^2]
  double max_step = 0;      ///< largest phase step between pixels [rad], < pi
};

/// Smooth regions of the phase, each unwrapped up to its own multiple of 2 pi.
struct Regions {
  Labels label;  ///< 0 ... count - 1, or -1
  Plane phase;   ///< [rad] unwrapped; meaningless where the label is -1
  int count = 0;
};

/// A pixel where the multiple of 2 pi missing from its unwrapped phase is known.
struct Marker {
  int pixel = 0;  ///< row * columns + column; outside all regions it has no effect
  int turns = 0;
};

/// Buffers reused by the functions below from frame to frame; they carry no state between calls.
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

/// Splits the regions whose markers disagree. This is needed where two surfaces meet at a depth
/// step of about a whole period, because the phase alone shows no border there. The largest step is
/// that of `grow_regions`; the variance and its limit may be others. Pixels in no region stay so.
///
/// A core is a connected part of a region after cutting all necks narrower than seven pixels. The
/// part behind such a neck may be another surface: a core without a marker that is large enough to
/// expect a stripe edge in it becomes a region of its own, whose depth stays unknown. A core whose
/// markers agree stays whole. The remaining pixels are flooded from these cores, and elsewhere from
/// the markers, in the order of variance, so that the parts meet where the phase is least smooth.
/// Parts of one region with the same number of turns share a label.
void split_regions(const Plane& wrapped, const Plane& variance, const FloodLimits& limits,
                   const std::vector<Marker>& markers, UnwrappingBuffers& buffers,
                   Regions& regions);

}  // namespace palpate::sensing
