// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "palpate/haptics/model.h"
#include "reduce/strokes.h"

namespace palpate::haptics {

/// [N²] By how much the sum of the squared differences of forces grows if one contact leaves a
/// model; infinite if the others have no triangulation. Only the strokes are played at whose ends
/// the contact has weight, because the others feel as before.
/// \param model with at least four contacts
/// \param ends of the strokes as they should feel, \param differences of the model from them [N].
[[nodiscard]] std::vector<double> contact_losses(const Model& model,
                                                 std::span<const Stroke> strokes,
                                                 std::span<const StrokeEnd> ends,
                                                 std::span<const double> differences);

}  // namespace palpate::haptics
