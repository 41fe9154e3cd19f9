// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "palpate/haptics/build_model.h"

namespace palpate::haptics {

/// The compared part of the forces: if contacts were only pressed, the model's forces across are an
/// assumption.
enum class Compared { whole_forces, along_pressing };

/// Returns the errors of each rule in predicting the samples of contacts from those around them, in
/// a time that grows only with the number of contacts. Nothing if no contact has others around it.
/// \param by_compliances, by_forces the same contacts, with compliances and with strengths.
/// \param samples of each contact, in its local frame.
[[nodiscard]] std::optional<RuleErrors> left_out_errors_of_rules(
    const Model& by_compliances, const Model& by_forces, std::span<const ForceSamples> samples,
    Compared compared = Compared::whole_forces);

/// [N] The same along the pressing, by the rule of the model; 0 if no contact has others around it.
[[nodiscard]] double left_out_pressing_error(const Model& model,
                                             std::span<const ForceSamples> samples);

}  // namespace palpate::haptics
