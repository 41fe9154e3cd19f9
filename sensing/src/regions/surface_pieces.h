// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "phase/surface_doubt.h"

namespace palpate::sensing {

/// Divides the image into pieces of one surface each, and cuts them apart: the pixels along their
/// borders, and those of pieces that are too small, get infinite variance.
///
/// A step of depth leaves no doubt where the phases of its two sides happen to agree, so that no
/// pixel and no narrow neck proves that a surface continues; a long border does. The image is
/// divided into square tiles. A line of pixels from the centre of a tile to that of its neighbour
/// speaks for one surface by as much as the largest doubt on it is below 1, and against it by as
/// much as that is above. The pieces with the strongest common border are joined, and the votes of
/// their borders with others added up, until no border is left that speaks for one surface (greedy
/// contraction for the minimum cost multicut: Keuper et al. 2015).
/// \param tile [px]
/// \param least_pixels smallest number of pixels with a phase in a piece; the doubt about one edge
/// leaves smaller ones along it.
void cut_into_pieces(const SurfaceDoubt& doubt, long tile, long least_pixels, Plane& variance);

}  // namespace palpate::sensing
