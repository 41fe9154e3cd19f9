// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image_plane.h"
#include "phase/demodulation.h"

namespace palpate::sensing {

/// Adds to the standard deviation of phases the error that lens blur causes in windows that end
/// beside the dark or at the border of the image, where a mosaic is interpolated badly.
///
/// A blur of 1 px, as `unmix_neighbours` assumes for the lens, costs the outermost pixel of a
/// column a share s of 31 % of its light. In the window around a pixel that gives it the weight w,
/// and has the weight W left in all, this moves the phase by s w / W sqrt(2 m^2 + 1/2), RMS over
/// the phases, where m is the mean of the blurred light over its amplitude.
/// \param sigma [rad] of the phases in the mask.
void add_edge_blur(const Mask& lit, const DemodulationFilter& filter, Plane& sigma);

}  // namespace palpate::sensing
