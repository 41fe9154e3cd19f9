// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "image/image_plane.h"

namespace palpate::sensing {

/// The change from one side of a pixel to the other that is rare on one surface, in the unit of the
/// change. What is rare depends on the image: on smooth surfaces of one colour, a hundredth of what
/// rough ones show all over is a step. It is a multiple of the typical change, between two limits.
struct DoubtfulChange {
  double most = 0;      ///< on rough surfaces
  double least = 0;     ///< on smooth ones: beyond what noise and the window of the phase leave
  double typicals = 0;  ///< multiple of the typical change between them
};

/// The doubtful change of an image in which less than half of the pixels are beside steps.
/// \param changes NaN where unknown.
[[nodiscard]] float doubtful_change(const Plane& changes, const DoubtfulChange& limits);

/// Adds to each pixel the square of its change as part of the doubtful one.
/// \param unknown added where the change is NaN.
void add_doubt(const Plane& changes, float doubtful, float unknown, Plane& doubt);

}  // namespace palpate::sensing
