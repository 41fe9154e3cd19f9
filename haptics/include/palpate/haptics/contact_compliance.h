// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Learns how contacts yield to a force, and how this changes along the surface, and returns the
/// model with `BlendRule::compliances`. Whatever builds or changes a model calls this once; the
/// result is stored with the model.
///
/// Each contact is pressed with the reference force [N] along the mean inward normal of the surface
/// around it. A contact whose field does not reach that force within the object's size gets no
/// compliance. The result does not depend on the frame of the world nor, but for rounding, on the
/// order of the contacts and a common turn of the local axes about z.
/// \throws InvalidInput unless the force is > 0 and finite, or if `check_model` refuses.
//
// The displacement under the force is where the elastic energy minus the work of the force is
// least, found from zero by Newton's method. The trend is that of ordinary kriging (Cressie 1993,
// sec. 3.2) of up to 32 contacts around, with places taken along the x and y axes of the contact's
// pressing frame and a Matern covariance of order 5/2. Its two length scales (along and across the
// direction in which compliances change most) and its noise are those of the largest likelihood
// (Rasmussen and Williams 2006, sec. 5.4.1). Two contacts are neighbours if they share a triangle
// of contacts or a vertex of the surface's weights; the contacts around one are its neighbours and
// theirs. The reach is twice the median distance of a contact to its nearest neighbour.
[[nodiscard]] Model with_compliances(Model model, double reference_force);

}  // namespace palpate::haptics
