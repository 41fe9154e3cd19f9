// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Prepares a model for blending forces: computes the strength of each contact, which is the work
/// of a press along its z axis to the reference depth [mm], divided by that depth, and its trend
/// along the surface, and sets `Interpolation`.
///
/// Linear weights alone cut corners where stiffness changes within the distance of two contacts.
/// The trend is that of ordinary kriging, as in `with_compliances`, along the x and y axes of the
/// contacts' frames.
/// \throws InvalidInput unless the depth is > 0 and finite, or if `check_model` rejects the model.
[[nodiscard]] Model with_strengths(Model model, double reference_depth);

}  // namespace palpate::haptics
