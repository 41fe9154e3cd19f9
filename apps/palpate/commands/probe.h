// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "palpate/probing/campaign.h"
#include "palpate/probing/campaign_store.h"
#include "shared/command_line.h"

namespace palpate::apps {

// Each function adds subcommands to `palpate probe`.

/// `probe truth`: surface and known forces of a specimen.
void add_probe_truth(CLI::App& probe, const Settings& settings);
/// `probe plan`: where to probe a surface.
void add_probe_plan(CLI::App& probe, const Settings& settings);
/// `probe run`, `probe resume` and `probe status`: a campaign.
void add_probe_run(CLI::App& probe, const Settings& settings);
/// `probe report`: a page with tables and pictures of a campaign.
void add_probe_report(CLI::App& probe, const Settings& settings);

/// Where a stored campaign stands: it takes the stored trials once more, without an arm.
/// \param source names the store in messages.
/// \throws FileError if the trials are not those that the plan and the options order.
[[nodiscard]] probing::Campaign replayed(const probing::CampaignStore& store,
                                         const std::string& source);
/// What `probe run` and `probe status` print with --json.
[[nodiscard]] nlohmann::ordered_json campaign_figures(const probing::Campaign& campaign);

}  // namespace palpate::apps
