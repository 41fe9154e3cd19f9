// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Makes the model blend compliances: computes the compliance of each contact under the reference
/// force [N] along the mean inward normal of the surface around it, weighted with its weight, and
/// its trend along the surface, and sets `Interpolation`.
///
/// The compliance is where the elastic energy minus the work of the force is least, found from zero
/// displacement by Newton's method; a contact whose field does not reach the force within the
/// object's size has none. The trend is that of ordinary kriging (Cressie 1993, sec. 3.2) of the
/// compliances of up to 32 contacts around, places taken along the x and y axes of the contact's
/// pressing frame: a Matern covariance of order 5/2 whose two length scales, along and across the
/// direction in which compliances change most, and noise make the likelihood of each contact
/// together with those around it largest (Rasmussen and Williams 2006, sec. 5.4.1). Contacts are
/// around one another that share a triangle of contacts or a vertex of the surface's weights, or do
/// so with one between. The reach is twice the median distance of a contact to the nearest one
/// around it. The result does not depend on the frame of the world or, but for rounding, on the
/// order of contacts and a common turn of the local axes about z.
/// \throws InvalidInput unless the force is > 0 and finite, or if `check_model` refuses.
[[nodiscard]] Model with_compliances(Model model, double reference_force);

}  // namespace palpate::haptics
