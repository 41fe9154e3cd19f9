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
#include "commands/probe_arm.h"
#include "commands/probe_campaign.h"
#include "palpate/error.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/arm_prober.h"
#include "palpate/probing/campaign.h"
#include "palpate/probing/campaign_store.h"
#include "palpate/probing/fingerprint.h"
#include "palpate/probing/probing_program.h"
#include "palpate/probing/rate_dependence.h"
#include "shared/call_checks.h"
#include "shared/inputs.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct RunCall {
  fs::path plan, store;
  bool dry_run = false;
  ArmCall arm;
  ArmWatch watch;
  probing::CampaignOptions options;
};

/// Contacts that an arm cannot probe, by reason: "2 too_far (contacts 5, 9)".
std::string out_of_reach(const probing::ContactPlan& plan, const probing::PlanReach& reach) {
  std::string text;
  for (std::size_t reason = 1; reason < probing::kReaches; ++reason) {
    if (reach.counts[reason] == 0) continue;
    std::string ids;
    for (std::size_t i = 0; i < plan.contacts.size(); ++i) {
      if (reach.contacts[i] == static_cast<probing::Reach>(reason))
        ids += fmt::format("{}{}", ids.empty() ? "" : ", ", plan.contacts[i].id);
    }
    text += fmt::format("{}{} {} (contacts {})", text.empty() ? "" : ", ", reach.counts[reason],
                        probing::to_string(static_cast<probing::Reach>(reason)), ids);
  }
  return text;
}

/// \throws InvalidInput naming the contacts that the arm cannot probe.
void check_reach(const CampaignArm& arm, const probing::ContactPlan& plan,
                 const std::string& source) {
  const probing::PlanReach reach = arm.reach(plan);
  if (reach.counts[0] == static_cast<int>(plan.contacts.size())) return;
  throw InvalidInput(fmt::format(
      "{}: the arm cannot probe {} of {} contacts: {}. Take them out of the plan, or place the arm "
      "otherwise ('pose' in --arm-config)",
      source, static_cast<int>(plan.contacts.size()) - reach.counts[0], plan.contacts.size(),
      out_of_reach(plan, reach)));
}

void perform(const Settings& settings, probing::CampaignStore& store, RunningCampaign running,
             const fs::path& path) {
  probing::Campaign& campaign = running.campaign;
  const probing::CampaignOptions options =
      probing::parse_campaign_options(store.description().strategy, path.string());
  const auto kept = [&] {
    return fmt::format("{} trials are kept; continue with: palpate probe resume {}",
                       campaign.progress().trials, path.string());
  };
  try {
    try {
      perform_trials(store, running, options);
    } catch (const probing::ArmStopped& stopped) {
      InterruptedByThrowing::check();  // Ctrl-C stops the arm too
      store.note("arm_stopped", stopped.what());
      throw DeviceError(fmt::format("the arm was stopped: {}; {}", stopped.what(), kept()));
    }
  } catch (Interrupted& interrupted) {
    interrupted.message = "interrupted; " + kept();
    throw;
  }
  if (const std::string aloud = beyond_reach(campaign.progress(), options); !aloud.empty())
    store.note("target", aloud);
  const probing::RateDependence rates =
      probing::rate_dependence(store.trials(campaign.plan().contacts), options.program);
  store.finish();
  Json figures = campaign_figures(campaign, options, rates);
  figures["fingerprint"] = probing::fingerprint(probing::read_acquisition(path).records());
  figures["output"] = path.string();
  print(settings, figures,
        campaign_words(campaign, options, rates) + "\nwritten to " + path.string());
}

/// "0.05N" is 0.05.
std::string without_newton(std::string text) {
  if (text.ends_with('N')) text.pop_back();
  return text;
}

void check_limits(const probing::CampaignOptions& options) {
  const bool limited = options.until > 0 || options.max_hours > 0 || options.max_samples > 0;
  const bool adaptive = options.strategy == probing::TrialStrategy::adaptive;
  if (adaptive && !limited) {
    throw InvalidInput(
        "palpate probe run: --strategy adaptive needs a limit: --until, --max-hours or "
        "--max-samples");
  }
  if (!adaptive && limited) {
    throw InvalidInput(
        "palpate probe run: --until, --max-hours and --max-samples are of --strategy adaptive; the "
        "others end when their plan is done");
  }
}

void run_campaign(const Settings& settings, const RunCall& call) {
  if (call.store.empty()) throw InvalidInput("palpate probe run: give -o, or --dry-run");
  check_limits(call.options);
  check_outputs({call.plan, call.arm.specimen, call.arm.setup, call.arm.replay},
                {call.store, call.watch.record});
  const InterruptedByThrowing interrupts;  // from the first byte of the store on, it can be resumed
  const probing::ContactPlan plan = probing::read_plan(call.plan);
  const std::string arm = describe_arm(call.arm);
  const std::string source =
      call.arm.replay.empty()
          ? call.arm.specimen.empty() ? call.arm.arm : call.arm.specimen.string()
          : call.arm.replay.string();
  RunningCampaign running{probing::Campaign(plan, call.options),
                          make_campaign_arm(arm, source, plan, {}, call.watch)};
  check_reach(*running.arm, plan, call.plan.string());
  probing::CampaignStore store =
      probing::CampaignStore::create(call.store, {.plan = probing::to_text(plan),
                                                  .strategy = probing::to_text(call.options),
                                                  .arm = arm,
                                                  .software = "palpate " PALPATE_VERSION});
  perform(settings, store, std::move(running), call.store);
}

/// Visits each contact at the height in which the arm travels, without touching.
void dry_run(const Settings& settings, const RunCall& call) {
  if (!call.store.empty())
    throw InvalidInput("--dry-run: measures nothing, so there is nothing to write; leave out -o");
  check_outputs({call.plan, call.arm.specimen, call.arm.setup, call.arm.replay},
                {call.watch.record});
  const InterruptedByThrowing interrupts;
  const probing::ContactPlan plan = probing::read_plan(call.plan);
  const std::unique_ptr<CampaignArm> arm =
      make_campaign_arm(describe_arm(call.arm), call.arm.arm, plan, {}, call.watch);
  if (!arm->moves())
    throw InvalidInput("--dry-run: a quasi-static arm does not move; give --arm virtual");
  const probing::PlanReach reach = arm->reach(plan);
  Json unreachable = Json::array();
  std::string words;
  int reached = 0;
  double seconds = 0;
  const auto miss = [&](const probing::Contact& contact, const char* reason) {
    unreachable.push_back({{"contact", contact.id}, {"reason", reason}});
    words += fmt::format("\ncontact {}: {}", contact.id, reason);
  };
  try {
    Progress progress("visiting");
    arm->start();
    for (std::size_t i = 0; i < plan.contacts.size(); ++i) {
      const probing::Contact& contact = plan.contacts[i];
      progress.show(static_cast<int>(i), static_cast<int>(plan.contacts.size()));
      if (reach.contacts[i] != probing::Reach::reachable) {
        miss(contact, probing::to_string(reach.contacts[i]));
        continue;
      }
      const probing::ProbeReport report = arm->perform(
          {.kind = probing::ProbeActionKind::travel,
           .trial = static_cast<long long>(i),
           .target = contact.position + call.options.program.clearance * contact.normal,
           .time_limit = call.options.program.travel_limit});
      seconds += report.seconds;
      if (report.outcome == probing::ProbeOutcome::done)
        ++reached;
      else
        miss(contact, probing::to_string(report.outcome));
    }
    arm->finish();
  } catch (const probing::ArmStopped& stopped) {
    InterruptedByThrowing::check();
    throw DeviceError(fmt::format("the arm was stopped: {}; {} of {} contacts were visited",
                                  stopped.what(), reached, plan.contacts.size()));
  }
  print(settings,
        {{"contacts", plan.contacts.size()},
         {"reached", reached},
         {"unreachable", unreachable},
         {"hours", seconds / kSecondsPerHour}},
        fmt::format("{} of {} contacts reached, {:.0f} mm above the surface{}", reached,
                    plan.contacts.size(), call.options.program.clearance, words));
  if (!unreachable.empty()) {
    throw Error(fmt::format("{}: {} of {} contacts were not reached", call.plan.string(),
                            unreachable.size(), plan.contacts.size()));
  }
}

void resume_campaign(const Settings& settings, const fs::path& path, const ArmWatch& watch) {
  const InterruptedByThrowing interrupts;
  probing::CampaignStore store = probing::CampaignStore::open(path);
  probing::Campaign campaign = replayed(store, path.string());
  auto arm = make_campaign_arm(store.description().arm, path.string(), campaign.plan(),
                               store.memory(), watch);
  perform(settings, store, {std::move(campaign), std::move(arm)}, path);
}

void show_status(const Settings& settings, const fs::path& path) {
  const probing::CampaignStore store = probing::CampaignStore::look(path);
  const probing::Campaign campaign = replayed(store, path.string());
  const probing::CampaignOptions options =
      probing::parse_campaign_options(store.description().strategy, path.string());
  const probing::RateDependence rates =
      probing::rate_dependence(store.trials(campaign.plan().contacts), options.program);
  print(settings, campaign_figures(campaign, options, rates),
        campaign_words(campaign, options, rates));
}

void add_stop_file(CLI::App& command, ArmWatch& watch) {
  command.add_option("--stop-file", watch.stop_file,
                     "Stop the arm within milliseconds of the moment at which this file exists");
}

}  // namespace

void add_probe_run(CLI::App& probe, const Settings& settings) {
  auto call = std::make_shared<RunCall>();
  probing::CampaignOptions& options = call->options;
  CLI::App* run = probe.add_subcommand("run", "Probe an object by a plan");
  run->add_option("PLAN", call->plan, "Plan of 'palpate probe plan'")->required();
  run->add_option("-o,--output", call->store,
                  "Store to write (acquisition.db); must not exist. Needed without --dry-run");
  run->add_option("--arm", call->arm.arm,
                  "quasi-static: simulated equilibria, quickly; virtual: a simulated arm with its "
                  "control loop at 1 kHz; or the driver of a device, a shared library")
      ->capture_default_str();
  run->add_option("--specimen", call->arm.specimen,
                  "Object of a simulated arm (JSON; docs/probing.md)");
  run->add_option("--arm-config", call->arm.setup,
                  "Setup of an arm: its pose, links, limits (JSON; docs/probing.md)");
  add_stop_file(*run, call->watch);
  run->add_option("--record", call->watch.record,
                  "Also write all that the arm measured and was commanded, at 1 kHz");
  run->add_option("--replay", call->arm.replay,
                  "In place of an arm: a file of --record, with the same plan and options");
  run->add_flag("--dry-run", call->dry_run,
                "Only visit all contacts, 20 mm above the surface, and name those out of reach");
  add_choice<probing::TrialStrategy>(
      *run, "--strategy", options.strategy,
      {{"pooled", probing::TrialStrategy::pooled},
       {"bisection", probing::TrialStrategy::bisection},
       {"adaptive", probing::TrialStrategy::adaptive}},
      "Choice of tangential forces: pooled: where they tell most about friction, with what other "
      "contacts have shown (default); bisection: halve the interval in each direction; adaptive: "
      "where trials reduce the error of the model most per second, until a limit below");
  run->add_option("--resolution", options.resolution, "At which a bisection ends [N]")
      ->check(within(above(0).finite()))
      ->capture_default_str();
  run->add_option("--friction-accuracy", options.friction_accuracy,
                  "pooled: standard deviation of a contact's coefficient at which no force is "
                  "tried for friction alone")
      ->check(within(above(0).finite()))
      ->capture_default_str();
  run->add_option("--until", options.until,
                  "adaptive: stated error of the model at which to stop [N], such as 0.05N")
      ->transform(without_newton)
      ->check(within(at_least(0).finite()));
  run->add_option("--max-hours", options.max_hours, "adaptive: hours of the arm at most")
      ->check(within(at_least(0).finite()));
  run->add_option("--max-samples", options.max_samples, "adaptive: samples at most")
      ->check(within(at_least(0)));
  run->add_option("--seed", options.seed, "Of the order of directions and the errors of the arm")
      ->capture_default_str();
  run->footer(
      "Each trial is stored at once: after Ctrl-C, a crash or a loss of power 'palpate probe "
      "resume' goes on, and the result is the same.\n"
      "A fault of an arm, the stop file and Ctrl-C take its force away at once; the trial does not "
      "count.\n"
      "Examples:\n  palpate probe run plan.json --specimen sheet.json -o acquisition.db\n"
      "  palpate probe run plan.json --arm ./libdevice.so --arm-config arm.json --dry-run");
  run->callback([call, &settings] {
    call->arm.seed = call->options.seed;
    if (call->dry_run)
      dry_run(settings, *call);
    else
      run_campaign(settings, *call);
  });

  CLI::App* resume = probe.add_subcommand("resume", "Go on with a campaign of 'probe run'");
  resume->add_option("ACQUISITION", call->store, "Store of the campaign (acquisition.db)")
      ->required();
  add_stop_file(*resume, call->watch);
  resume->footer("Example:\n  palpate probe resume acquisition.db");
  resume->callback([call, &settings] { resume_campaign(settings, call->store, call->watch); });

  CLI::App* status = probe.add_subcommand(
      "status", "Show what is done and left of a campaign, also while it runs");
  status->add_option("ACQUISITION", call->store, "Store of the campaign (acquisition.db)")
      ->required();
  status->footer("Example:\n  palpate probe status acquisition.db --json");
  status->callback([call, &settings] { show_status(settings, call->store); });
}

}  // namespace palpate::apps
