// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "probing/probe_report.h"

#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/campaign_options_text.h"
#include "probing/probe.h"
#include "probing/probe_campaign.h"
#include "shared/model_pictures.h"
#include "shared/output_checks.h"

namespace palpate::apps {
namespace {

/// A contact is predicted from at least three others.
constexpr std::size_t kLeastLeftOut = 4;

struct ReportCall {
  fs::path store, model, queries, record, output;
};

/// All files that a report of this campaign can have, of an earlier model also.
std::vector<fs::path> report_files(const probing::Campaign& campaign) {
  std::vector<fs::path> files{"index.html",    "timeline.png",    "errors.png",
                              "touch.png",     "gravity-0.png",   "gravity-1.png",
                              "gravity-2.png", "force-errors.png"};
  for (std::size_t level = 0; level < campaign.plan().normal_forces.size(); ++level)
    files.emplace_back(fmt::format("displacements-{}.png", level));
  for (const probing::Contact& contact : campaign.plan().contacts)
    files.emplace_back(fmt::format("contact-{}.png", contact.id));
  return files;
}

void write_page(const fs::path& folder, const CampaignReport& input) {
  ReportPage page("Report of a probing campaign");
  add_summary(page, input);
  add_time_line(page, folder, input);
  add_displacements(page, folder, input);
  add_samples(page, folder, input);
  add_errors(page, folder, input);
  if (input.session) add_arm(page, folder, *input.session);
  add_contact_table(page, input);
  write_file(folder / "index.html", [&](std::ostream& out) { out << page.html(); });
}

void report(const Settings& settings, const ReportCall& call) {
  check_outputs({call.store, call.model, call.queries, call.record}, {call.output});
  const CampaignReport input = read_report(call.store, call.model, call.queries, call.record);
  write_report(call.output, input);
  Json figures = campaign_figures(input.campaign, input.options, input.findings);
  figures["queries_rms"] =
      number_or_null(input.queries ? std::optional(input.queries->rms) : std::nullopt);
  figures["leave_one_out_rms"] =
      number_or_null(input.left_out ? std::optional(input.left_out->rms) : std::nullopt);
  figures["output"] = call.output.string();
  print(settings, figures, "written to " + (call.output / "index.html").string());
}

}  // namespace

CampaignReport read_report(const fs::path& store, const fs::path& model, const fs::path& queries,
                           const fs::path& record) {
  const probing::CampaignStore campaign = probing::CampaignStore::look(store);
  CampaignReport report{
      .campaign = replayed(campaign, store.string()),
      .trials = {},
      .references = campaign.references(),
      .findings = {},
      .options = probing::parse_campaign_options(campaign.description().strategy, store.string()),
      .software = campaign.description().software,
      .acquisition = probing::read_acquisition(store),
      .model = haptics::read_model(model),
      .left_out = {},
      .queries = {},
      .session = {}};
  report.trials = campaign.trials(report.campaign.plan().contacts);
  report.findings = findings_of(campaign, report.campaign.plan(), report.options);
  if (report.trials.empty())
    throw InvalidInput(store.string() + ": has no trial yet; there is nothing to report");
  if (report.model.contacts.size() >= kLeastLeftOut)
    report.left_out = haptics::leave_one_out(report.model, report.acquisition, {.suggestions = 0});
  if (!queries.empty())
    report.queries = haptics::evaluate_queries(report.model, haptics::read_queries(queries));
  if (!record.empty()) {
    report.session = read_session(record, report.campaign, report.options, report.trials,
                                  report.model.contacts[median_contact(report.model)].id);
  }
  return report;
}

void write_report(const fs::path& folder, const CampaignReport& report) {
  write_folder(folder, report_files(report.campaign),
               [&](const fs::path& place) { write_page(place, report); });
}

void add_probe_report(CLI::App& probe, const Settings& settings) {
  auto call = std::make_shared<ReportCall>();
  CLI::App* command =
      probe.add_subcommand("report", "Make a page with tables and pictures of a campaign");
  command->add_option("ACQUISITION", call->store, "Store of the campaign (acquisition.db)")
      ->required();
  command->add_option("MODEL", call->model, "Model folder that was fitted to it")->required();
  command->add_option("--queries", call->queries,
                      "Known forces to compare with (queries.csv of 'palpate probe truth')");
  command->add_option(
      "--record", call->record,
      "Record of the arm (session.arm of 'palpate probe run --record'): adds a "
      "touch, the compensation of gravity and, if the arm has a sensor of its own for them, "
      "the errors of forces");
  command->add_option("-o,--output", call->output, "Folder for index.html and its pictures")
      ->required();
  command->footer("Example:\n  palpate probe report acquisition.db model/ -o report/");
  command->callback([call, &settings] { report(settings, *call); });
}

}  // namespace palpate::apps
