// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "probing/probe_campaign.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <optional>

#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/triangle_mesh.h"
#include "palpate/probing/campaign_options_text.h"
#include "palpate/probing/campaign_trial.h"
#include "shared/command_line.h"
#include "shared/progress.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

/// Shares above which a difference is reported. The virtual arm, whose force errs by 0.03 N on each
/// way and whose objects damp a little, shows a loss of 0.19 on an elastic body.
constexpr double kNoticedLoss = 0.3, kNoticedCreep = 0.1;
/// [mm] Change of the displacement under the reference force above which it is reported, if noise
/// alone does not explain it: as far as an object may be displaced when a campaign is resumed.
constexpr double kNoticedDrift = 0.1;
constexpr double kBeyondNoise = 3;  // standard deviations

std::string words_of_stop(probing::AdaptiveStop stop) {
  switch (stop) {
    case probing::AdaptiveStop::accurate:
      return "ended: the stated error is what was asked for";
    case probing::AdaptiveStop::max_hours:
      return "ended: no time is left";
    case probing::AdaptiveStop::max_samples:
      return "ended: all samples were taken";
    default:
      return "";
  }
}

/// "20 range maps; nothing of use was seen in trials 3, 17"
std::string words_of_camera(const CampaignFindings& findings) {
  constexpr std::size_t kNamed = 5;
  const std::vector<long long>& not_seen = findings.not_seen;
  std::string words = counted(static_cast<std::size_t>(findings.range_maps), "range map");
  if (not_seen.empty()) return words;
  const auto named =
      not_seen.begin() + static_cast<std::ptrdiff_t>(std::min(kNamed, not_seen.size()));
  words += fmt::format("; nothing of use was seen in trial{} {}", not_seen.size() > 1 ? "s" : "",
                       fmt::join(not_seen.begin(), named, ", "));
  if (not_seen.size() > kNamed) words += fmt::format(" and {} more", not_seen.size() - kNamed);
  return words;
}

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

/// The surface of a real object, if it is given.
/// \throws InvalidInput if the plan is of another one.
std::optional<geometry::TriangleMesh> planned_surface(const probing::ContactPlan& plan,
                                                      const fs::path& plan_path,
                                                      const fs::path& surface_path) {
  if (surface_path.empty()) return std::nullopt;
  geometry::TriangleMesh surface = geometry::read_mesh(surface_path);
  if (probing::surface_fingerprint(surface) != plan.surface) {
    throw InvalidInput(
        fmt::format("{}: the plan {} is of another surface; give the one it was made of, or plan "
                    "again",
                    surface_path.string(), plan_path.string()));
  }
  return surface;
}

}  // namespace

probing::Campaign replayed(const probing::CampaignStore& store, const std::string& source) {
  const probing::CampaignDescription& description = store.description();
  probing::Campaign campaign(probing::parse_plan(description.plan, source),
                             probing::parse_campaign_options(description.strategy, source));
  const std::vector<probing::ReferenceProbe> references = store.references();
  auto reference = references.begin();
  const auto refuse = [&](const char* what, long long number) {
    throw FileError(fmt::format(
        "{}: {} {} is not what its plan and its options order; the store was changed, or is of "
        "another version of palpate",
        source, what, number));
  };
  const auto take_references = [&](long long trials) {
    try {
      for (; reference != references.end() && reference->trials <= trials; ++reference)
        campaign.take_reference(*reference);
    } catch (const InvalidInput&) {
      refuse("reference probe", reference->number);
    }
  };
  for (const probing::TrialRecord& record : store.trials(campaign.plan().contacts)) {
    take_references(record.order.trial);
    try {
      (void)campaign.take(record);
    } catch (const InvalidInput&) {
      refuse("trial", record.order.trial);
    }
  }
  take_references(std::numeric_limits<long long>::max());
  return campaign;
}

CampaignFindings findings_of(const probing::CampaignStore& store, const probing::ContactPlan& plan,
                             const probing::CampaignOptions& options) {
  CampaignFindings findings{
      .rates = probing::rate_dependence(store.trials(plan.contacts), options.program),
      .drift = probing::reference_drift(store.references(), plan, options.program),
      .has_camera = !store.description().camera.empty(),
      .range_maps = store.range_maps(),
      .not_seen = {}};
  for (const probing::CampaignEvent& event : store.events())
    if (event.kind == "no_range_map") findings.not_seen.push_back(event.trial);
  return findings;
}

Json campaign_figures(const probing::Campaign& campaign, const probing::CampaignOptions& options,
                      const CampaignFindings& findings) {
  const probing::CampaignProgress at = campaign.progress();
  const probing::RateDependence& rates = findings.rates;
  std::vector<double> errors;
  for (const probing::ConeEstimate& cone : campaign.cones())
    errors.push_back(cone.coefficient_error);
  std::optional<double> typical_error;
  if (!errors.empty()) typical_error = median(errors);
  const bool complete = !campaign.next();
  Json figures{{"contacts", at.contacts},
               {"contacts_done", at.contacts_done},
               {"contacts_given_up", at.contacts_given_up},
               {"trials", at.trials},
               {"samples", at.samples},
               {"slipped", at.slipped},
               {"hours", at.seconds / kSecondsPerHour},
               {"trials_left", std::llround(at.trials_left)},
               {"hours_left", at.seconds_left / kSecondsPerHour},
               {"friction_error", number_or_null(typical_error)},
               {"energy_lost", rates.energy_lost},
               {"energy_loops", rates.loops},
               {"creep", rates.creep},
               {"references", findings.drift.probes},
               {"drift", findings.drift.change},
               {"complete", complete}};
  if (findings.has_camera) {
    figures["range_maps"] = findings.range_maps;
    figures["not_seen"] = findings.not_seen;
  }
  if (options.strategy == probing::TrialStrategy::adaptive) {
    figures["stated_error"] = at.stated.error;
    figures["stated_at_contacts"] = at.stated.at_contacts;
    figures["stated_between"] = at.stated.between;
    figures["reachable_error"] = at.stated.reachable;
    figures["predicted_over_actual"] = at.stated.predicted_over_actual;
    figures["stop"] = probing::to_string(at.stop);
  }
  return figures;
}

std::string beyond_reach(const probing::CampaignProgress& at,
                         const probing::CampaignOptions& options) {
  if (options.strategy != probing::TrialStrategy::adaptive || options.until == 0) return "";
  if (at.stop == probing::AdaptiveStop::exhausted) {
    return fmt::format(
        "{} N were not reached: each contact has as many samples as help. Plan more contacts "
        "(--spacing), or accept the error",
        options.until);
  }
  if (options.until < options.program.force_noise) {
    return fmt::format("{} N are below the noise of the arm's forces, {} N: they cannot be reached",
                       options.until, options.program.force_noise);
  }
  if (std::isfinite(at.stated.reachable) && at.stated.reachable > options.until) {
    return fmt::format(
        "{} N are likely to be below what this plan can reach, about {}: noise and the gaps "
        "between contacts remain. Plan more contacts (--spacing)",
        options.until, newtons(at.stated.reachable, 3));
  }
  return "";
}

std::string beyond_statics(const probing::RateDependence& rates) {
  if (rates.energy_lost >= kNoticedLoss) {
    return fmt::format(
        "unloading differs from loading by {:.0f} % of the energy (median of {} trials): a "
        "quasi-static model does not show this",
        100 * rates.energy_lost, rates.loops);
  }
  if (rates.creep >= kNoticedCreep) {
    return fmt::format(
        "{:.0f} % of the displacement came after the force was constant (median of {} trials): a "
        "quasi-static model does not show this",
        100 * rates.creep, rates.creeps);
  }
  return "";
}

std::string beyond_steadiness(const probing::ReferenceDrift& drift) {
  if (!(std::abs(drift.change) > std::max(kNoticedDrift, kBeyondNoise * drift.error))) return "";
  return fmt::format(
      "the displacement under the reference force changed by {:.2f} mm ({} probes): the object, "
      "its place or the arm is not what it was",
      drift.change, drift.probes);
}

std::string campaign_words(const probing::Campaign& campaign,
                           const probing::CampaignOptions& options,
                           const CampaignFindings& findings) {
  const probing::CampaignProgress at = campaign.progress();
  std::string text = fmt::format(
      "{} of {} done, {} given up\n{} in {:.1f} h, {}, of which {} slipped", at.contacts_done,
      counted(at.contacts, "contact"), at.contacts_given_up, counted(at.trials, "trial"),
      at.seconds / kSecondsPerHour, counted(at.samples, "sample"), at.slipped);
  if (campaign.next())
    text += fmt::format("\nabout {:.0f} trials left, {:.1f} h", at.trials_left,
                        at.seconds_left / kSecondsPerHour);
  for (const std::string& more :
       {beyond_statics(findings.rates), beyond_steadiness(findings.drift)}) {
    if (!more.empty()) text += "\n" + more;
  }
  if (findings.has_camera) text += "\n" + words_of_camera(findings);
  if (options.strategy != probing::TrialStrategy::adaptive) return text;
  if (std::isfinite(at.stated.error)) {
    text += fmt::format("\nstated error {}, {} at contacts", newtons(at.stated.error, 3),
                        newtons(at.stated.at_contacts, 3));
  }
  for (const std::string& more : {words_of_stop(at.stop), beyond_reach(at, options)}) {
    if (!more.empty()) text += "\n" + more;
  }
  return text;
}

std::string trials_kept(const probing::Campaign& campaign) {
  return counted(campaign.progress().trials, "trial is kept", "trials are kept");
}

void perform_trials(probing::CampaignStore& store, RunningCampaign& running,
                    const probing::CampaignOptions& options, int most) {
  probing::Campaign& campaign = running.campaign;
  Progress progress("probing");
  const InterruptMessage message(trials_kept(campaign));
  if (running.camera) running.camera->begin();
  probing::Prober& prober = running.camera ? running.camera->prober() : *running.arm;
  if (campaign.next()) running.arm->start();
  const auto show = [&] {
    const probing::CampaignProgress at = campaign.progress();
    InterruptMessage::set_kept(trials_kept(campaign));
    progress.show(at.trials, at.trials + std::max(1, static_cast<int>(at.trials_left)));
  };
  for (int i = 0; i < most && campaign.next(); ++i) {
    show();
    probing::perform_trial(campaign, prober, store, options.program,
                           [&] { running.arm->keep_record(); });
  }
  running.arm->keep_record();
}

probing::PlanReach reach_of_arm(const CampaignArm& arm, const probing::ContactPlan& plan,
                                const fs::path& plan_path, const fs::path& surface_path) {
  const std::optional<geometry::TriangleMesh> surface =
      planned_surface(plan, plan_path, surface_path);
  if (arm.is_device() && !surface) {
    spdlog::warn(
        "Whether the links of the arm stay away from the object is not checked: give --surface.");
  }
  return arm.reach(plan, surface ? &*surface : nullptr);
}

void check_reach(const CampaignArm& arm, const probing::ContactPlan& plan,
                 const fs::path& plan_path, const fs::path& surface_path) {
  const probing::PlanReach reach = reach_of_arm(arm, plan, plan_path, surface_path);
  if (reach.counts[0] == static_cast<int>(plan.contacts.size())) return;
  throw InvalidInput(fmt::format(
      "{}: the arm cannot probe {} of {} contacts: {}. Take them out of the plan, or place the arm "
      "otherwise ('pose' in --arm-config)",
      plan_path.string(), static_cast<int>(plan.contacts.size()) - reach.counts[0],
      plan.contacts.size(), out_of_reach(plan, reach)));
}

}  // namespace palpate::apps
