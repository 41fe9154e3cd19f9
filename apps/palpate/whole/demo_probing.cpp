// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/documents/document.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/campaign_options_text.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/specimen_file.h"
#include "probing/campaign_report.h"
#include "probing/probe.h"
#include "probing/probe_campaign.h"
#include "whole/demo.h"

namespace palpate::apps {
namespace {

/// Begins a campaign, leaves it half way like a crash, opens its store again and continues.
/// \return the number of trials that were stored when it was left.
int run_in_two_parts(const fs::path& path, const probing::ContactPlan& plan,
                     const fs::path& specimen) {
  const probing::CampaignOptions options;
  ArmCall call;
  call.specimen = specimen;
  call.seed = options.seed;
  const std::string arm = describe_arm(call);
  for (const char* part : {"", "-wal", "-shm"}) fs::remove(path.string() + part);
  int before = 0;
  {
    RunningCampaign running{probing::Campaign(plan, options),
                            make_campaign_arm(arm, specimen.string(), plan, {}, {})};
    probing::CampaignStore store =
        probing::CampaignStore::create(path, {.plan = probing::to_text(plan),
                                              .strategy = probing::to_text(options),
                                              .arm = arm,
                                              .software = "palpate " PALPATE_VERSION});
    before = static_cast<int>(running.campaign.progress().trials_left / 2);
    perform_trials(store, running, options, before);
  }
  probing::CampaignStore store = probing::CampaignStore::open(path);
  probing::Campaign campaign = replayed(store, path.string());
  auto same_arm = make_campaign_arm(arm, path.string(), plan, store.memory(), {});
  RunningCampaign running{std::move(campaign), std::move(same_arm)};
  perform_trials(store, running, options);
  store.finish();
  return before;
}

/// Errors of the friction coefficients of a model.
geometry::ErrorStatistics coefficient_errors(const haptics::Model& model,
                                             const probing::Specimen& specimen) {
  std::vector<double> errors;
  for (const haptics::ContactModel& contact : model.contacts)
    errors.push_back(contact.friction - specimen.friction_cone(contact.position).coefficient);
  return geometry::error_statistics(std::move(errors));
}

}  // namespace

Json demo_probing(const fs::path& data, const fs::path& output) {
  const fs::path folder = output / "probing", store = folder / "acquisition.db";
  const fs::path file = data / "probing/sheet_block.json";
  const auto specimen = probing::parse_specimen(documents::read_json_text(file), file.string());
  write_truth(folder / "truth", *specimen);
  const probing::ContactPlan plan = probing::plan_contacts(specimen->surface());
  probing::write_plan(folder / "plan.json", plan);
  const int before = run_in_two_parts(store, plan, file);

  const haptics::BuildResult built =
      haptics::build_model(probing::read_acquisition(store), specimen->surface());
  haptics::write_model(folder / "model", built.model);
  const CampaignReport report =
      read_report(store, folder / "model", folder / "truth" / kTruthQueries);
  write_report(folder / "report", report);
  const probing::CampaignProgress done = report.campaign.progress();
  return {{"name", file.stem().string()},
          {"contacts", done.contacts_done},
          {"trials", done.trials},
          {"trials_before", before},
          {"samples", done.samples},
          {"slipped", done.slipped},
          {"hours", done.seconds / kSecondsPerHour},
          {"queries_rms", report.queries.value().rms},
          {"leave_one_out_rms", report.left_out.value().rms},
          {"friction_error", coefficient_errors(built.model, *specimen).median}};
}

}  // namespace palpate::apps
