// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/haptics/build_model.h"
#include "palpate/haptics/realignment.h"

namespace palpate::haptics {

// Steps of `build_model`. `samples` are those of each contact, in its local frame.

/// Fits the field of every contact, in parallel. Contacts whose displacements do not show all
/// directions come last: they take what the others show there.
void fit_fields(const std::vector<ForceSamples>& samples, const FitOptions& fit_options,
                const BuildOptions& options, BuildResult& result);

/// Fields of contacts that were only pressed, from the estimate of all of them together.
void take_pressing(const std::vector<ForceSamples>& samples, const FitOptions& options,
                   BuildResult& result);

/// Share of the norm of a pressed contact's stiffness that lies along the pressing. An error of the
/// touch acts through it alone.
[[nodiscard]] double along_pressing(const PressingEstimate& estimate);

/// \throws SolverError naming contacts whose fit cannot be used.
void check_usable(const std::vector<ContactReport>& contacts);

/// \throws SolverError if a field gives more than ten times the largest force at its own samples.
void check_predictions(const std::vector<ForceSamples>& samples, const BuildResult& result);

}  // namespace palpate::haptics
