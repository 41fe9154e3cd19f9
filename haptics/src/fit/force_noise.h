// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/haptics/force_field_fit.h"
#include "palpate/haptics/realignment.h"

namespace palpate::haptics {

/// [N] The noise of a component of the forces. It is `repeated`, what repeated forces show, but at
/// least 0.4 % of the largest force of a contact (median), if that explains the errors of most of a
/// few contacts that represent all; otherwise the noise that explains those of half of them. With a
/// limit of accuracy or bases, for computed pairs (`compare_always`) and in other modes than
/// `convex`, errors are expected: they do not count.
/// \param contacts at least one
/// \param options its noise of the forces is not used
[[nodiscard]] double estimated_force_noise(const std::vector<ForceSamples>& contacts,
                                           double repeated, FitOptions options);

}  // namespace palpate::haptics
