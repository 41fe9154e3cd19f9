// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <vector>

#include "palpate/probing/campaign.h"
#include "palpate/probing/closed_form.h"
#include "palpate/probing/quasi_static_arm.h"

// Shared by the tests of campaigns.
namespace palpate::probing::support {

/// A plan of a few contacts of a sheet.
inline ContactPlan small_plan(const Specimen& specimen, int contacts = 4) {
  return plan_contacts(specimen.surface(),
                       {.spacing = 20, .contacts = contacts, .highest_force = 3, .levels = 5});
}

/// Performs up to `most` trials.
inline std::vector<TrialRecord> perform(Campaign& campaign, Prober& arm,
                                        const CampaignOptions& options, int most = 1 << 20) {
  std::vector<TrialRecord> records;
  while (static_cast<int>(records.size()) < most) {
    const std::optional<TrialOrder> order = campaign.next();
    if (!order) break;
    records.push_back({*order, run_trial(arm, *order, options.program)});
    (void)campaign.take(records.back());
  }
  return records;
}

}  // namespace palpate::probing::support
