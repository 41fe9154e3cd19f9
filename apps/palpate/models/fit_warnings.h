// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/build_model.h"
#include "palpate/probing/acquisition.h"
#include "shared/aliases.h"

// Warnings of `palpate fit`. Each function adds its warnings to the list `warnings`.
namespace palpate::apps {

/// Warns of properties that were not measured, so that the model only assumes them.
void tell_gaps(const probing::CheckedAcquisition& acquisition, Json& warnings);
/// Warns of fits that are complete, but explain the measurements badly.
void tell_doubts(const haptics::BuildResult& built, Json& warnings);
/// Warns of measurements of a campaign that a quasi-static model does not show.
void tell_rates(const fs::path& acquisition, Json& warnings);

}  // namespace palpate::apps
