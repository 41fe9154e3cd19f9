// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "commands/probe.h"
#include "palpate/error.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/campaign.h"
#include "palpate/probing/campaign_store.h"
#include "palpate/probing/fingerprint.h"
#include "palpate/probing/quasi_static_arm.h"
#include "palpate/probing/specimen_file.h"
#include "shared/call_checks.h"
#include "shared/inputs.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr double kHour = 3600;  // [s]

struct RunCall {
  fs::path plan, specimen, store;
  probing::CampaignOptions options;
};

/// A campaign with the arm that performs it.
struct Running {
  probing::Campaign campaign;
  std::unique_ptr<probing::Prober> arm;
};

/// The simulated arm that a text describes: its specimen and its seed.
std::unique_ptr<probing::Prober> arm_of(const std::string& text, const std::string& source,
                                        const probing::ContactPlan& plan) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object() || !json.contains("specimen") || !json.contains("seed"))
    throw FileError(source +
                    ": does not say which arm probes; expected the store of "
                    "'palpate probe run'");
  std::shared_ptr<const probing::Specimen> specimen =
      probing::parse_specimen(json["specimen"].get<std::string>(), source);
  if (probing::surface_fingerprint(specimen->surface()) != plan.surface) {
    throw InvalidInput(source +
                       ": the plan is of another surface than that of the specimen. Plan with "
                       "--specimen, or with the surface.ply of 'palpate probe truth'");
  }
  return probing::make_quasi_static_arm(specimen, {.seed = json["seed"].get<std::uint64_t>()});
}

std::string words_of(const probing::Campaign& campaign) {
  const probing::CampaignProgress at = campaign.progress();
  std::string text = fmt::format(
      "{} of {} contacts done, {} given up\n{} trials in {:.1f} h, {} samples, of which {} slipped",
      at.contacts_done, at.contacts, at.contacts_given_up, at.trials, at.seconds / kHour,
      at.samples, at.slipped);
  if (campaign.next())
    text += fmt::format("\nabout {:.0f} trials left, {:.1f} h", at.trials_left,
                        at.seconds_left / kHour);
  return text;
}

void perform(const Settings& settings, probing::CampaignStore& store, Running running,
             const fs::path& path) {
  probing::Campaign& campaign = running.campaign;
  const probing::CampaignOptions options =
      probing::parse_campaign_options(store.description().strategy, path.string());
  try {
    Progress progress("probing");
    while (const std::optional<probing::TrialOrder> order = campaign.next()) {
      const probing::CampaignProgress at = campaign.progress();
      progress.show(at.trials, at.trials + std::max(1, static_cast<int>(at.trials_left)));
      const probing::TrialRecord record{*order,
                                        probing::run_trial(*running.arm, *order, options.program)};
      const probing::TrialVerdict verdict = campaign.take(record);
      store.append(record, verdict, at.seconds);
    }
  } catch (Interrupted& interrupted) {
    interrupted.message =
        fmt::format("interrupted; {} trials are kept; continue with: palpate probe resume {}",
                    campaign.progress().trials, path.string());
    throw;
  }
  store.finish();
  Json figures = campaign_figures(campaign);
  figures["fingerprint"] = probing::fingerprint(probing::read_acquisition(path).records());
  figures["output"] = path.string();
  print(settings, figures, words_of(campaign) + "\nwritten to " + path.string());
}

void run_campaign(const Settings& settings, const RunCall& call) {
  check_outputs({call.plan, call.specimen}, {call.store});
  const InterruptedByThrowing interrupts;  // from the first byte of the store on, it can be resumed
  const probing::ContactPlan plan = probing::read_plan(call.plan);
  const Json arm{{"specimen", probing::read_specimen_text(call.specimen)},
                 {"seed", call.options.seed}};
  Running running{probing::Campaign(plan, call.options),
                  arm_of(arm.dump(), call.specimen.string(), plan)};
  probing::CampaignStore store =
      probing::CampaignStore::create(call.store, {.plan = probing::to_text(plan),
                                                  .strategy = probing::to_text(call.options),
                                                  .arm = arm.dump(),
                                                  .software = "palpate " PALPATE_VERSION});
  perform(settings, store, std::move(running), call.store);
}

void resume_campaign(const Settings& settings, const fs::path& path) {
  probing::CampaignStore store = probing::CampaignStore::open(path);
  probing::Campaign campaign = replayed(store, path.string());
  auto arm = arm_of(store.description().arm, path.string(), campaign.plan());
  perform(settings, store, {std::move(campaign), std::move(arm)}, path);
}

void show_status(const Settings& settings, const fs::path& path) {
  const probing::CampaignStore store = probing::CampaignStore::look(path);
  const probing::Campaign campaign = replayed(store, path.string());
  print(settings, campaign_figures(campaign), words_of(campaign));
}

}  // namespace

probing::Campaign replayed(const probing::CampaignStore& store, const std::string& source) {
  const probing::CampaignDescription& description = store.description();
  probing::Campaign campaign(probing::parse_plan(description.plan, source),
                             probing::parse_campaign_options(description.strategy, source));
  for (const probing::TrialRecord& record : store.trials(campaign.plan().contacts)) {
    try {
      (void)campaign.take(record);
    } catch (const InvalidInput&) {
      throw FileError(fmt::format(
          "{}: trial {} is not what its plan and its options order; the store was changed, or is "
          "of another version of palpate",
          source, record.order.trial));
    }
  }
  return campaign;
}

Json campaign_figures(const probing::Campaign& campaign) {
  const probing::CampaignProgress at = campaign.progress();
  std::vector<double> errors;
  for (const probing::ConeEstimate& cone : campaign.cones())
    errors.push_back(cone.coefficient_error);
  std::optional<double> median;
  if (!errors.empty()) {
    const auto middle = errors.begin() + static_cast<std::ptrdiff_t>(errors.size() / 2);
    std::nth_element(errors.begin(), middle, errors.end());
    median = *middle;
  }
  const bool complete = !campaign.next();
  return {{"contacts", at.contacts},
          {"contacts_done", at.contacts_done},
          {"contacts_given_up", at.contacts_given_up},
          {"trials", at.trials},
          {"samples", at.samples},
          {"slipped", at.slipped},
          {"hours", at.seconds / kHour},
          {"trials_left", std::llround(at.trials_left)},
          {"hours_left", at.seconds_left / kHour},
          {"friction_error", number_or_null(median)},
          {"complete", complete}};
}

void add_probe_run(CLI::App& probe, const Settings& settings) {
  auto call = std::make_shared<RunCall>();
  probing::CampaignOptions& options = call->options;
  CLI::App* run = probe.add_subcommand("run", "Probe a simulated object by a plan");
  run->add_option("PLAN", call->plan, "Plan of 'palpate probe plan'")->required();
  run->add_option("--specimen", call->specimen, "Simulated object (JSON; docs/probing.md)")
      ->required();
  run->add_option("-o,--output", call->store, "Store to write (acquisition.db); must not exist")
      ->required();
  add_choice<probing::TrialStrategy>(
      *run, "--strategy", options.strategy,
      {{"pooled", probing::TrialStrategy::pooled},
       {"bisection", probing::TrialStrategy::bisection}},
      "Choice of tangential forces: pooled: where they tell most about friction, with what other "
      "contacts have shown (default); bisection: halve the interval in each direction");
  run->add_option("--resolution", options.resolution, "At which a bisection ends [N]")
      ->check(within(above(0).finite()))
      ->capture_default_str();
  run->add_option("--friction-accuracy", options.friction_accuracy,
                  "pooled: standard deviation of a contact's coefficient at which no force is "
                  "tried for friction alone")
      ->check(within(above(0).finite()))
      ->capture_default_str();
  run->add_option("--seed", options.seed, "Of the order of directions and the errors of the arm")
      ->capture_default_str();
  run->footer(
      "Each trial is stored at once: after Ctrl-C, a crash or a loss of power 'palpate probe "
      "resume' goes on, and the result is the same.\n"
      "Example:\n  palpate probe run plan.json --specimen sheet.json -o acquisition.db");
  run->callback([call, &settings] { run_campaign(settings, *call); });

  CLI::App* resume = probe.add_subcommand("resume", "Go on with a campaign of 'probe run'");
  resume->add_option("ACQUISITION", call->store, "Store of the campaign (acquisition.db)")
      ->required();
  resume->footer("Example:\n  palpate probe resume acquisition.db");
  resume->callback([call, &settings] { resume_campaign(settings, call->store); });

  CLI::App* status = probe.add_subcommand(
      "status", "Show what is done and left of a campaign, also while it runs");
  status->add_option("ACQUISITION", call->store, "Store of the campaign (acquisition.db)")
      ->required();
  status->footer("Example:\n  palpate probe status acquisition.db --json");
  status->callback([call, &settings] { show_status(settings, call->store); });
}

}  // namespace palpate::apps
