// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstddef>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/arm_prober.h"
#include "palpate/probing/campaign.h"
#include "palpate/probing/campaign_options_text.h"
#include "palpate/probing/campaign_store.h"
#include "palpate/probing/fingerprint.h"
#include "palpate/probing/object_shift.h"
#include "palpate/probing/probing_program.h"
#include "probing/probe.h"
#include "probing/probe_arm.h"
#include "probing/probe_campaign.h"
#include "shared/call_checks.h"
#include "shared/field_options.h"
#include "shared/output_checks.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

/// Contacts that are touched again before a device continues, and touches of each. A touch scatters
/// by 0.03 mm along the approach.
constexpr int kTouchedContacts = 3, kTouchesOfContact = 5;

struct RunCall {
  fs::path plan, store, surface;
  bool dry_run = false;
  ArmCall arm;
  CameraCall camera;
  ArmWatch watch;
  probing::CampaignOptions options;
  double moved_limit = 0.1;  // [mm]
};

/// Touches a real object again where it was touched before the campaign was interrupted.
/// \throws Error if it has moved.
void check_not_moved(probing::CampaignStore& store, RunningCampaign& running,
                     const probing::CampaignOptions& options, double limit, const fs::path& path) {
  const std::vector<probing::ContactTouches> before =
      probing::reference_touches(store.trials(running.campaign.plan().contacts), kTouchedContacts);
  if (before.empty()) return;
  running.arm->start();
  const std::vector<probing::ContactTouches> now =
      probing::touch_again(*running.arm, before, kTouchesOfContact, options.program);
  running.arm->keep_record();
  std::string words;
  bool moved = false;
  for (const probing::ObjectShift& shift : probing::object_shift(before, now, options.program)) {
    moved = moved || probing::has_moved(shift, limit);
    words += fmt::format("{}contact {}: ", words.empty() ? "" : ", ", shift.contact);
    words += shift.touches == 0 ? std::string("nothing was touched")
                                : fmt::format("{:+.2f} ± {:.2f} mm", shift.shift, shift.error);
  }
  store.note(moved ? "object_moved" : "object_checked", words);
  if (!moved) return;
  throw Error(fmt::format(
      "{}: the object is not where it was when the campaign was interrupted; outwards along the "
      "normal, {}; at most {} mm are allowed (--moved-limit). Put it back, or begin a new "
      "campaign; {}",
      path.string(), words, limit, trials_kept(running.campaign)));
}

/// Notes the record of the arm in the store when a part of the campaign begins, or warns of none.
void note_record(probing::CampaignStore& store, const fs::path& record, int trials) {
  if (!record.empty()) {
    return store.note("recorded",
                      fmt::format("{} from trial {} on", fs::absolute(record).string(), trials));
  }
  const std::vector<probing::CampaignEvent> events = store.events();
  const auto earlier = std::find_if(events.begin(), events.end(),
                                    [](const auto& event) { return event.kind == "recorded"; });
  if (earlier != events.end()) {
    spdlog::warn("Earlier trials were recorded ({}), those that follow are not: give --record.",
                 earlier->text);
  }
}

/// \param goes_on true if trials were performed before.
void perform(const Settings& settings, probing::CampaignStore& store, RunningCampaign running,
             const RunCall& call, bool goes_on) {
  const fs::path& path = call.store;
  probing::Campaign& campaign = running.campaign;
  const probing::CampaignOptions options =
      probing::parse_campaign_options(store.description().strategy, path.string());
  const std::string how_to_continue = "continue with: palpate probe resume " + path.string();
  const InterruptMessage message(trials_kept(campaign), how_to_continue);
  try {
    note_record(store, call.watch.record, campaign.progress().trials);
    if (goes_on && running.arm->is_device() && campaign.next())
      check_not_moved(store, running, options, call.moved_limit, path);
    perform_trials(store, running, options);
  } catch (const probing::ArmStopped& stopped) {
    InterruptMessage::set_kept(trials_kept(campaign));
    InterruptedByThrowing::check();  // Ctrl-C stops the arm too
    store.note("arm_stopped", stopped.what());
    throw DeviceError(fmt::format("the arm was stopped: {}; {}; {}", stopped.what(),
                                  trials_kept(campaign), how_to_continue));
  } catch (const DeviceError& failed) {
    throw DeviceError(
        fmt::format("{}; {}; {}", failed.what(), trials_kept(campaign), how_to_continue));
  }
  if (const std::string aloud = beyond_reach(campaign.progress(), options); !aloud.empty())
    store.note("target", aloud);
  const CampaignFindings findings = findings_of(store, campaign.plan(), options);
  store.finish();
  Json figures = campaign_figures(campaign, options, findings);
  figures["fingerprint"] = probing::fingerprint(probing::read_acquisition(path).records());
  figures["output"] = path.string();
  std::string words = campaign_words(campaign, options, findings) + "\nwritten to " + path.string();
  if (!call.watch.record.empty()) words += "\narm recorded in " + call.watch.record.string();
  print(settings, figures, words);
}

/// Lets a camera look at the arm, if one is described.
void add_camera(RunningCampaign& running, const std::string& description, const fs::path& store) {
  if (description.empty()) return;
  running.camera =
      std::make_unique<CampaignCamera>(description, store, running.campaign.plan(), *running.arm);
}

/// "0.05N" is 0.05.
std::string without_newton(std::string text) {
  if (text.ends_with('N')) text.pop_back();
  return text;
}

void run_campaign(const Settings& settings, const RunCall& call) {
  if (call.store.empty()) throw InvalidInput("palpate probe run: give -o, or --dry-run");
  check_outputs({call.plan, call.arm.specimen, call.arm.setup, call.arm.replay, call.surface,
                 call.camera.rig, call.camera.pattern, call.camera.colors, call.camera.sensor},
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
  const std::string camera = describe_camera(call.camera, call.options.seed);
  add_camera(running, camera, call.store);
  check_camera_folders(camera, call.store);
  check_reach(*running.arm, plan, call.plan, call.surface);
  // A plan is for the tip of an arm; a simulated object has its own.
  const std::shared_ptr<const probing::Specimen> specimen = running.arm->specimen();
  probing::CampaignStore store = probing::CampaignStore::create(
      call.store, {.plan = probing::to_text(plan),
                   .strategy = probing::to_text(call.options),
                   .arm = arm,
                   .software = "palpate " PALPATE_VERSION,
                   .camera = camera,
                   .probe_radius = specimen ? specimen->tip_radius() : plan.options.tip_radius});
  perform(settings, store, std::move(running), call, false);
}

/// Visits each contact at the height in which the arm travels, without touching.
void dry_run(const Settings& settings, const RunCall& call) {
  if (!call.store.empty())
    throw InvalidInput("--dry-run: measures nothing, so there is nothing to write; leave out -o");
  if (!call.camera.camera.name.empty())
    throw InvalidInput(
        "--dry-run: measures nothing, so there is nothing to see; leave out --camera");
  check_outputs({call.plan, call.arm.specimen, call.arm.setup, call.arm.replay, call.surface},
                {call.watch.record});
  const InterruptedByThrowing interrupts;
  const probing::ContactPlan plan = probing::read_plan(call.plan);
  const std::unique_ptr<CampaignArm> arm =
      make_campaign_arm(describe_arm(call.arm), call.arm.arm, plan, {}, call.watch);
  if (!arm->moves())
    throw InvalidInput("--dry-run: a quasi-static arm does not move; give --arm virtual");
  const probing::PlanReach reach = reach_of_arm(*arm, plan, call.plan, call.surface);
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
      progress.show(i, plan.contacts.size());
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
    arm->keep_record();
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

/// The arm of a store, or a record in its place.
std::unique_ptr<CampaignArm> resumed_arm(const probing::CampaignStore& store,
                                         const probing::ContactPlan& plan, const RunCall& call) {
  const bool replays = !call.arm.replay.empty();
  const std::string description = replays ? describe_arm(call.arm) : store.description().arm;
  const fs::path& source = replays ? call.arm.replay : call.store;
  return make_campaign_arm(description, source.string(), plan, store.memory(), call.watch);
}

void resume_campaign(const Settings& settings, const RunCall& call) {
  check_outputs({call.store, call.arm.replay}, {call.watch.record});
  if (fs::exists(call.watch.record)) {
    throw InvalidInput(call.watch.record.string() +
                       ": exists already; a record holds one part of a campaign, from its run or "
                       "resume to its end. Choose another name");
  }
  const InterruptedByThrowing interrupts;
  probing::CampaignStore store = probing::CampaignStore::open(call.store);
  probing::Campaign campaign = replayed(store, call.store.string());
  auto arm = resumed_arm(store, campaign.plan(), call);
  RunningCampaign running{std::move(campaign), std::move(arm)};
  add_camera(running, moved_camera(store.description().camera, call.camera, call.store),
             call.store);
  perform(settings, store, std::move(running), call, true);
}

void add_stop_file(CLI::App& command, ArmWatch& watch) {
  command.add_option("--stop-file", watch.stop_file,
                     "Stop the arm within milliseconds of the moment at which this file exists");
}

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

void add_probe_run(CLI::App& probe, const Settings& settings) {
  auto call = std::make_shared<RunCall>();
  CLI::App* run = probe.add_subcommand("run", "Probe an object according to a plan");
  add_required(*run, "PLAN", call->plan, "Plan of 'palpate probe plan'");
  run->add_option("-o,--output", call->store,
                  "Store to write (acquisition.db); must not exist. Needed without --dry-run");
  run->add_option("--arm", call->arm.arm,
                  "quasi-static: simulated equilibria, quickly; virtual: a simulated arm with its "
                  "control loop at 1 kHz; or the driver of a device, a shared library")
      ->capture_default_str();
  run->add_option("--specimen", call->arm.specimen,
                  "Object of a simulated arm (JSON or YAML; docs/probing.md)");
  run->add_option("--surface", call->surface,
                  "Surface of the plan: the links of a device are kept away from it");
  run->add_option("--arm-config", call->arm.setup,
                  "Setup of an arm: its pose, links, limits (JSON or YAML; docs/probing.md)");
  add_stop_file(*run, call->watch);
  run->add_option("--record", call->watch.record,
                  "Also write all that the arm measured and was commanded, at 1 kHz");
  run->add_option("--replay", call->arm.replay,
                  "Instead of an arm: a file of --record, with the same plan and options");
  run->add_flag("--dry-run", call->dry_run,
                "Only visit all contacts, 20 mm above the surface, and name those out of reach");
  add_campaign_camera(*run, call->camera);
  add_fields(*run, fields_of(call->options));
  run->get_option("--until")->transform(without_newton);
  run->footer(
      "Each trial is stored at once: after Ctrl-C, a crash or a loss of power 'palpate probe "
      "resume' goes on, and the result is the same.\n"
      "A fault of an arm, the stop file and Ctrl-C take its force away at once; the trial does not "
      "count.\n"
      "Examples:\n  palpate probe run plan.json --specimen sheet.json -o acquisition.db\n"
      "  palpate probe run plan.json --specimen body.json --camera simulated --rig rig.yaml "
      "--pattern pattern.yaml --colors colors.yaml -o seen/acquisition.db\n"
      "  palpate probe run plan.json --arm ./libdevice.so --arm-config arm.json --dry-run");
  run->callback([call, &settings] {
    call->arm.seed = call->options.seed;
    if (call->dry_run)
      dry_run(settings, *call);
    else
      run_campaign(settings, *call);
  });

  CLI::App* resume = probe.add_subcommand("resume", "Continue a campaign of 'probe run'");
  add_required(*resume, "ACQUISITION", call->store, "Store of the campaign (acquisition.db)");
  add_stop_file(*resume, call->watch);
  for (CLI::Option* option : add_camera_files(*resume, call->camera))
    option->group("Where the files of the camera are now");
  resume->add_option("--record", call->watch.record,
                     "Also write what the arm does from here on, as --record of 'probe run'; must "
                     "not exist: each part of a campaign has its own record");
  resume->add_option("--replay", call->arm.replay,
                     "In place of the arm: the record of this part of the campaign");
  add_number(*resume, "--moved-limit", call->moved_limit, above(0).finite(),
             "Largest motion of the object along the normals with which a device goes on "
             "[mm]")
      ->capture_default_str();
  resume->footer(
      "A device touches a few contacts again, and refuses to go on if the object has moved.\n"
      "Examples:\n  palpate probe resume acquisition.db\n"
      "  palpate probe resume acquisition.db --record session2.arm");
  resume->callback([call, &settings] { resume_campaign(settings, *call); });
}

void add_probe_status(CLI::App& probe, const Settings& settings) {
  auto path = std::make_shared<fs::path>();
  CLI::App* status =
      probe.add_subcommand("status", "Show the progress of a campaign, also while it runs");
  add_required(*status, "ACQUISITION", *path, "Store of the campaign (acquisition.db)");
  status->footer("Example:\n  palpate probe status acquisition.db --json");
  status->callback([path, &settings] { show_status(settings, *path); });
}

}  // namespace palpate::apps
