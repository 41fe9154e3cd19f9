// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// The contacts of a model, which state one part of their own errors each time. The squares of the
/// errors that `force_variance` computes with these add up to those of the contacts as they are.
struct ContactErrorParts {
  std::vector<ContactModel> force_noise, position_noise, fit, across;
};

[[nodiscard]] ContactErrorParts contact_error_parts(const Model& model);

}  // namespace palpate::haptics
