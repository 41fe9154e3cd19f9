// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "image/image_plane.h"
#include "palpate/geometry/camera.h"

namespace palpate::sensing {

/// Pixel i of the half-size image covers pixels 2 i and 2 i + 1 of the full image. Since pixel
/// centres are at whole numbers, its centre is at 2 i + 1/2. An odd last row or column is left out.

/// Converts a coordinate of the full image to the half-size image [px].
[[nodiscard]] constexpr double half_size(double pixel) { return (pixel - 0.5) / 2; }

/// The camera of the half-size image: the same rays through the same lens.
/// \param camera must be at least two pixels wide and high.
[[nodiscard]] geometry::Camera half_size(const geometry::Camera& camera);

/// Halves images: binomial weights 1 3 3 1 along the columns, in which the sinusoid varies (two
/// pixels at the border), and means of two pixels along the rows.
///
/// Plain means along the columns would alias onto the sinusoid nearly half of any light that
/// alternates from row to row, such as the rows that a demosaiced red channel lacks: 0.1 rad at a
/// period of 7 px. The binomial weights leave a tenth of that, without a loss in signal to noise.
/// The memory of `half` is reused.
void half_size(const std::vector<Plane>& whole, std::vector<Plane>& half);

}  // namespace palpate::sensing
