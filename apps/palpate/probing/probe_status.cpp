// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/probing/campaign.h"
#include "palpate/probing/campaign_options_text.h"
#include "palpate/probing/campaign_store.h"
#include "probing/probe.h"
#include "probing/probe_campaign.h"

namespace palpate::apps {
namespace {

constexpr int kShownEvents = 5;  // the latest

/// The latest events as lines.
std::string events_in_words(const std::vector<probing::CampaignEvent>& events) {
  std::string words;
  const std::size_t hidden = events.size() - std::min<std::size_t>(events.size(), kShownEvents);
  if (hidden > 0) words += fmt::format("\n{} earlier events: see --json", hidden);
  for (std::size_t i = hidden; i < events.size(); ++i) {
    words += fmt::format("\n{}, {}: {}",
                         events[i].trial < 0 ? std::string("before the first trial")
                                             : fmt::format("trial {}", events[i].trial),
                         events[i].kind, events[i].text);
  }
  return words;
}

void show_status(const Settings& settings, const fs::path& path) {
  const probing::CampaignStore store = probing::CampaignStore::look(path);
  const probing::Campaign campaign = replayed(store, path.string());
  const probing::CampaignOptions options =
      probing::parse_campaign_options(store.description().strategy, path.string());
  const CampaignFindings findings = findings_of(store, campaign.plan(), options);
  const std::vector<probing::CampaignEvent> events = store.events();
  Json figures = campaign_figures(campaign, options, findings);
  figures["events"] = Json::array();
  for (const probing::CampaignEvent& event : events)
    figures["events"].push_back(
        {{"trial", event.trial}, {"kind", event.kind}, {"text", event.text}});
  print(settings, figures, campaign_words(campaign, options, findings) + events_in_words(events));
}

}  // namespace

void add_probe_status(CLI::App& probe, const Settings& settings) {
  auto path = std::make_shared<fs::path>();
  CLI::App* status =
      probe.add_subcommand("status", "Show the progress of a campaign, also while it runs");
  status->add_option("ACQUISITION", *path, "Store of the campaign (acquisition.db)")->required();
  status->footer("Example:\n  palpate probe status acquisition.db --json");
  status->callback([path, &settings] { show_status(settings, *path); });
}

}  // namespace palpate::apps
