// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Turns the contacts' frames about their z axes so that neighbours agree on x and y as well as
/// their z axes let them; the fields turn back, so that no contact's force changes.
///
/// Between contacts forces are blended in the mean of their frames, which is only continuous where
/// they are less than half a turn apart, and only sensible where they are near each other. The
/// angles are the phases of the smoothest field of directions on the triangulation of the contacts
/// (Knoppel, Crane, Pinkall and Schroder 2013): the eigenvector of the smallest eigenvalue of the
/// connection Laplacian, whose connection is the smallest turn from one z axis to the other. On a
/// closed surface no field is smooth everywhere: the Euler characteristic says how many turns are
/// left, in single triangles, and this keeps them few.
void align_frames(Model& model);

}  // namespace palpate::haptics
