// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <span>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// Fits the fields of contacts again with fewer bases where these follow the old ones closely
/// enough. New fields are convex, and so passive.
/// \param error [N] RMS difference, over presses and drags, that a field may have.
/// \param depths [mm] > 0, of presses at each contact.
/// \param too_small [N] the largest error known at which each field has no simpler one. Such fields
/// are not fitted again, and it is raised to `error` where there is none. If empty, none is known.
/// \return the number of fields that were replaced.
int simplify_fields(Model& model, double error, std::span<const double> depths,
                    std::span<double> too_small = {});

}  // namespace palpate::haptics
