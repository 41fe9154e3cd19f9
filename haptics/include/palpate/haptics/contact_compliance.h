// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Prepares a model for blending compliances: computes the compliance of each contact under the
/// reference force [N] along the mean inward normal of the surface around it (weighted with its
/// weight), and its trend along the surface, and sets `Interpolation`.
///
/// The compliance is the displacement that minimises elastic energy minus the work of the force,
/// found from zero displacement by Newton's method. A contact whose field does not reach the force
/// within the object's size has none.
///
/// The trend is that of ordinary kriging (Cressie 1993, sec. 3.2) of the compliances of up to 32
/// contacts around, with places measured along the x and y axes of the contact's pressing frame.
/// The covariance is Matern of order 5/2 with two length scales, along and across the direction in
/// which compliances change most; scales and noise maximise the likelihood of each contact together
/// with those around it (Rasmussen and Williams 2006, sec. 5.4.1). Two contacts are around each
/// other if they share a triangle of contacts or a vertex of the surface's weights, or both share
/// one with a third contact. The reach is twice the median distance of a contact to the nearest one
/// around it. The result does not depend on the world frame or, up to rounding, on the order of
/// contacts or a common rotation of the local axes about z.
/// \throws InvalidInput unless the force is > 0 and finite, or if `check_model` rejects the model.
[[nodiscard]] Model with_compliances(Model model, double reference_force);

}  // namespace palpate::haptics
