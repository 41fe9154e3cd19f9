// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "image/image_plane.h"
#include "phase/demodulation.h"

namespace palpate::sensing {

/// Standard deviation of the lens' blur [px] for which the edges of surfaces are eroded.
inline constexpr double kEdgeBlur = 1;

/// Restores in an eroded mask the pixels beside the outermost ones that no blur has reached: an
/// ideal camera has sharp edges.
///
/// At two pixels from an edge, where `erode` with that radius begins to keep pixels, a blur of 1 px
/// has taken 2.3 % of the light. A pixel nearer to the edge that has lost no more, compared with
/// the most light (sum of the channels' means) within the radius, is as good. The outermost pixel
/// itself is not: surfaces fill it in part.
/// \param mask   as it was eroded.
/// \param radius [px] by which it was eroded; >= 1.
/// \param inner  the eroded mask; input and output.
void keep_sharp_edges(const std::vector<Demodulated>& channels, const Mask& mask, int radius,
                      Mask& inner);

}  // namespace palpate::sensing
