// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/sensing/trained_colors.h"

namespace palpate::sensing {

/// The hues [rad, in [0, 2 pi)] of all pixels that are bright and saturated enough and not clipped.
/// \throws InvalidInput if an image has another type or an option is outside its range.
[[nodiscard]] std::vector<float> training_hues(const NamedImages& named,
                                               const TrainingOptions& options);

}  // namespace palpate::sensing
