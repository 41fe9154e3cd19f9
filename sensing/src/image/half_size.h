// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "image/image_plane.h"
#include "palpate/geometry/camera.h"

namespace palpate::sensing {

/// Pixel i of an image of half the size covers pixels 2 i and 2 i + 1 of the whole one; with
/// centres at whole numbers it lies at 2 i + 1/2. The last row or column of an odd number is left
/// out.

/// Where a coordinate of the whole image lies in the half one [px].
[[nodiscard]] constexpr double half_size(double pixel) { return (pixel - 0.5) / 2; }

/// The camera that sees the half image: the same rays through the same lens.
/// \param camera at least two pixels wide and high.
[[nodiscard]] geometry::Camera half_size(const geometry::Camera& camera);

/// Along the columns, in which the sinusoid varies, the binomial weights 1 3 3 1 (two pixels at the
/// image's border), along the rows the mean of two. Plain means would fold nearly half of what
/// alternates from row to row onto the sinusoid, such as the rows that a demosaiced red never saw:
/// 0.1 rad at a period of 7 px. These leave a tenth, and lose nothing of the sinusoid against the
/// noise. Memory of `half` is used again.
void half_size(const std::vector<Plane>& whole, std::vector<Plane>& half);

}  // namespace palpate::sensing
