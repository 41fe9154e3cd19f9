// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "palpate/haptics/model.h"
#include "reduce/strokes.h"

namespace palpate::haptics {

/// [N] RMS of the errors that a model states where strokes end; nothing if a contact states none.
[[nodiscard]] std::optional<double> stated_error(const Model& model,
                                                 std::span<const StrokeEnd> ends);

/// The contacts of a reduced model state other errors between them: the most likely ones at the
/// ends of strokes, with the full model's own error there and the difference of the two forces at
/// the same displacement. A contact without information from any stroke keeps its own errors.
/// Nothing changes if a contact of the full model states none.
void state_reduced_errors(const Model& full, std::span<const StrokeEnd> ends, Model& reduced);

}  // namespace palpate::haptics
