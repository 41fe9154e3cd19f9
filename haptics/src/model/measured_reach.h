// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// How far an object was pressed, at a usual contact.
struct MeasuredReach {
  double force = 0;  ///< [N] > 0
  double depth = 0;  ///< [mm] > 0
};

/// How far a model was measured: up to its reference force or depth. If it states none, a tenth of
/// its size. A model without any force counts as one of 1 N.
[[nodiscard]] MeasuredReach measured_reach(const Model& model);

}  // namespace palpate::haptics
