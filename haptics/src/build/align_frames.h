// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Rotates the contacts' frames about their z axes so that neighbours agree on x and y as well as
/// their z axes allow; the fields are rotated back, so that no contact's force changes.
/// Between contacts forces are blended in the mean of their frames, which is continuous only if
/// they differ by less than half a turn, and sensible only if they are similar. The angles are the
/// phases of the smoothest direction field on the triangulation of the contacts (Knoppel, Crane,
/// Pinkall and Schroder 2013): the eigenvector of the smallest eigenvalue of the connection
/// Laplacian, whose connection is the smallest rotation between z axes. On a closed surface no
/// field is smooth everywhere: the Euler characteristic gives the number of turns that remain, in
/// single triangles, and this method keeps them few.
void align_frames(Model& model);

}  // namespace palpate::haptics
