// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>

#include "palpate/haptics/build_model.h"

namespace palpate::haptics {

/// What of the forces is compared: where contacts were only pressed, what the model gives across is
/// an assumption.
enum class Compared { whole_forces, along_pressing };

/// How well each rule predicts the samples of contacts from those around them; in a time that grows
/// with the number of contacts only. Nothing if no contact has others around it.
/// \param by_compliances, by_forces the same contacts, with compliances and with strengths.
/// \param samples of each contact, in its local frame.
[[nodiscard]] std::optional<RuleErrors> left_out_errors_of_rules(
    const Model& by_compliances, const Model& by_forces, std::span<const ForceSamples> samples,
    Compared compared = Compared::whole_forces);

/// [N] The same along the pressing, by the rule of the model; 0 if no contact has others around it.
[[nodiscard]] double left_out_pressing_error(const Model& model,
                                             std::span<const ForceSamples> samples);

}  // namespace palpate::haptics
