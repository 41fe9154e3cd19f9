// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "models/fit_warnings.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "models/fit_report.h"
#include "palpate/probing/campaign_options_text.h"
#include "palpate/probing/campaign_store.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/plausibility.h"
#include "palpate/probing/rate_dependence.h"
#include "probing/probe_campaign.h"
#include "shared/plausible.h"

namespace palpate::apps {
void tell_gaps(const probing::CheckedAcquisition& acquisition, Json& warnings) {
  const std::vector<long long> contacts = probing::probed_in_one_direction(acquisition);
  if (contacts.empty()) return;
  const bool all = contacts.size() == acquisition.contacts().size();
  warn(
      warnings, "one_direction",
      fmt::format("at {}, all forces have one direction: the stiffness across it was not measured. "
                  "Forces of the model against a drag there are an assumption, and so is its "
                  "friction. Only presses in that direction can be relied on; drag the tool in at "
                  "least four directions to measure the others",
                  all ? "all contacts"
                      : fmt::format("{} of {} contacts ({})", contacts.size(),
                                    acquisition.contacts().size(), contacts_in_words(contacts))));
}

void tell_doubts(const haptics::BuildResult& built, Json& warnings) {
  constexpr double kLeastExplained = 0.9;  // share of the squared forces
  // Of the samples: the rate of wrong marks that the fit of friction allows for.
  constexpr double kMostContradicting = 0.05;
  const double explained = haptics::explained_share(built.contacts);
  if (explained < kLeastExplained) {
    warn(warnings, "poorly_explained",
         fmt::format("the model explains only {:.0f} % of the measured forces (squared): errors "
                     "are {:.0f} % of the forces. Check the groups, signs and units of the "
                     "measurements, and the noise of the forces, which is taken as {:.3g} N "
                     "(--force-noise)",
                     100 * explained, 100 * std::sqrt(1 - explained), built.model.noise->force));
  }
  int contradictions = 0, trials = 0;
  for (const haptics::ContactReport& contact : built.contacts) {
    if (!contact.friction_contradictions) continue;
    contradictions += *contact.friction_contradictions;
    trials += contact.friction_trials;
  }
  if (contradictions > kMostContradicting * trials) {
    warn(warnings, "friction_contradicted",
         fmt::format("the friction that was found contradicts {} of {} samples: they held outside "
                     "of the friction cone, or are marked as slipped inside it. Check the column "
                     "slipped",
                     contradictions, trials));
  }
}

void tell_rates(const fs::path& acquisition, Json& warnings) {
  const std::optional<probing::CampaignStore> campaign = probing::CampaignStore::find(acquisition);
  if (!campaign) return;
  const std::string source = acquisition.string();
  const probing::ContactPlan plan = probing::parse_plan(campaign->description().plan, source);
  const probing::CampaignOptions options =
      probing::parse_campaign_options(campaign->description().strategy, source);
  const std::string more =
      beyond_statics(probing::rate_dependence(campaign->trials(plan.contacts), options.program));
  if (!more.empty()) warn(warnings, "rate_dependent", source + ": " + more);
}

}  // namespace palpate::apps
