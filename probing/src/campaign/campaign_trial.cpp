// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/campaign_trial.h"

#include <optional>

namespace palpate::probing {

bool perform_trial(Campaign& campaign, Prober& arm, CampaignStore& store,
                   const ProgramOptions& options, const std::function<void()>& performed) {
  const std::optional<TrialOrder> order = campaign.next();
  if (!order) return false;
  const auto perform = [&](const TrialOrder& ordered) {
    TrialResult result = run_trial(arm, ordered, options);
    if (performed) performed();
    return result;
  };
  if (const std::optional<TrialOrder> reference = campaign.reference()) {
    const CampaignProgress before = campaign.progress();
    const ReferenceProbe probe{.number = before.references,
                               .trials = before.trials,
                               .time = before.seconds,
                               .result = perform(*reference)};
    campaign.take_reference(probe);
    store.append(probe, *reference, arm.memory());
  }
  const double time = campaign.progress().seconds;
  const TrialRecord record{*order, perform(*order)};
  const TrialVerdict verdict = campaign.take(record);
  store.append(record, verdict, time, arm.memory());
  return true;
}

}  // namespace palpate::probing
