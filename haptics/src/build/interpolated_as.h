// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>

#include "palpate/haptics/contact_compliance.h"
#include "palpate/haptics/contact_strength.h"

namespace palpate::haptics {

/// The model with what the rule needs of its contacts, learnt from them as they are now.
[[nodiscard]] inline Model interpolated_as(Model model, const Interpolation& as) {
  if (as.rule == BlendRule::compliances)
    return with_compliances(std::move(model), as.reference_force);
  return as.reference_depth > 0 ? with_strengths(std::move(model), as.reference_depth) : model;
}

}  // namespace palpate::haptics
