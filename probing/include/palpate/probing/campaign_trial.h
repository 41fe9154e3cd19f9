// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "palpate/probing/campaign.h"
#include "palpate/probing/campaign_store.h"
#include "palpate/probing/prober.h"

namespace palpate::probing {

/// Performs the next trial of a campaign, and before it the reference probe if one is due, and
/// stores both.
/// \param performed called after each of them, before it is stored; may be empty.
/// \return whether there was a trial; false if the campaign is complete.
/// \throws OutputError if it cannot be stored, and whatever the arm throws.
bool perform_trial(Campaign& campaign, Prober& arm, CampaignStore& store,
                   const ProgramOptions& options, const std::function<void()>& performed = {});

}  // namespace palpate::probing
