// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "probing/campaign_report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/haptics/model_io.h"
#include "palpate/pictures/draw_displacements.h"
#include "palpate/pictures/draw_time_line.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/campaign_options_text.h"
#include "probing/probe.h"
#include "shared/model_pictures.h"
#include "shared/output_checks.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

std::string force_in_words(std::optional<double> force) {
  return force ? newtons(*force, 3) : std::string("unknown");
}

pictures::TrialKind kind_of(probing::TrialOutcome outcome) {
  switch (outcome) {
    case probing::TrialOutcome::held:
      return pictures::TrialKind::held;
    case probing::TrialOutcome::slipped:
    case probing::TrialOutcome::fell_off:
      return pictures::TrialKind::slipped;
    default:
      return pictures::TrialKind::failed;
  }
}

pictures::TimeLine time_line(const CampaignReport& input) {
  std::map<long long, int> number;
  for (const probing::Contact& contact : input.campaign.plan().contacts)
    number.emplace(contact.id, static_cast<int>(number.size()));
  const auto count = static_cast<Eigen::Index>(input.trials.size());
  pictures::TimeLine line{Eigen::VectorXd(count), {}, Eigen::VectorXi(count)};
  double seconds = 0;
  auto reference = input.references.begin();
  for (Eigen::Index i = 0; i < count; ++i) {
    const probing::TrialRecord& record = input.trials[static_cast<std::size_t>(i)];
    for (; reference != input.references.end() && reference->trials <= record.order.trial;
         ++reference)
      seconds += reference->result.seconds;
    seconds += record.result.seconds;
    line.hours(i) = seconds / kSecondsPerHour;
    line.kinds.push_back(kind_of(record.result.outcome));
    line.contacts(i) = number.at(record.order.contact.id);
  }
  return line;
}

/// [mm] the mean displacement along the normal under the normal force of a level, at each contact
/// of the model; NaN if the level was not tried there.
Eigen::VectorXd displacements(const CampaignReport& input, int level) {
  std::map<long long, std::pair<double, int>> sums;
  for (const probing::TrialRecord& record : input.trials) {
    const probing::Contact& contact = record.order.contact;
    const double depth = (contact.position - record.result.a).dot(contact.normal);
    if (record.order.level != level || !std::isfinite(depth)) continue;
    auto& [sum, count] = sums[contact.id];
    sum += depth;
    ++count;
  }
  Eigen::VectorXd means = Eigen::VectorXd::Constant(
      static_cast<Eigen::Index>(input.model.contacts.size()), std::nan(""));
  for (Eigen::Index i = 0; i < means.size(); ++i) {
    const auto found = sums.find(input.model.contacts[static_cast<std::size_t>(i)].id);
    if (found != sums.end()) means(i) = found->second.first / found->second.second;
  }
  return means;
}

/// The contacts whose fields fit best, as the median, and worst; fewer if there are fewer.
std::set<std::size_t> shown_contacts(const haptics::Model& model) {
  const std::vector<std::size_t> order = contacts_by_error(model);
  return {order.front(), order[order.size() / 2], order.back()};
}

void add_summary(ReportPage& page, const CampaignReport& input) {
  const probing::CampaignProgress at = input.campaign.progress();
  const probing::ContactPlan& plan = input.campaign.plan();
  std::vector<std::vector<std::string>> rows{
      {"Program", input.software},
      {"Contacts planned", std::to_string(at.contacts)},
      {"Contacts done", std::to_string(at.contacts_done)},
      {"Contacts given up", std::to_string(at.contacts_given_up)},
      {"Trials", std::to_string(at.trials)},
      {"Samples", std::to_string(at.samples)},
      {"Samples that slipped", std::to_string(at.slipped)},
      {"Hours of the arm", fmt::format("{:.2f}", at.seconds / kSecondsPerHour)},
      {"Normal forces", fmt::format("{} from {:.3g} to {:.3g} N", plan.normal_forces.size(),
                                    plan.normal_forces.front(), plan.normal_forces.back())}};
  if (std::isfinite(plan.cover)) {
    rows.push_back({"Largest distance from a contact", fmt::format("{:.1f} mm", plan.cover)});
  }
  const probing::RateDependence& rates = input.findings.rates;
  if (rates.loops > 0) {
    rows.push_back(
        {"Energy of a drag that its release did not give back",
         fmt::format("{:.0f} % (median of {} trials)", 100 * rates.energy_lost, rates.loops)});
  }
  if (rates.creeps > 0) {
    rows.push_back(
        {"Displacement after the force was constant",
         fmt::format("{:.0f} % (median of {} trials)", 100 * rates.creep, rates.creeps)});
  }
  const probing::ReferenceDrift& drift = input.findings.drift;
  if (std::isfinite(drift.change)) {
    rows.push_back({"Change of the displacement under the reference force",
                    fmt::format("{:.3f} ± {:.3f} of {:.2f} mm ({} probes)", drift.change,
                                drift.error, drift.displacement, drift.probes)});
  }
  page.add_table({}, rows);
  for (const std::string& more : {beyond_statics(rates), beyond_steadiness(drift)}) {
    if (!more.empty()) page.add_paragraph("Note: " + more + ".");
  }
}

void add_time_line(ReportPage& page, const fs::path& folder, const CampaignReport& input) {
  page.add_heading("Time line");
  pictures::draw_time_line(folder / "timeline.png", time_line(input), "Trials of the campaign");
  page.add_picture(
      "timeline.png",
      "Upper chart: trials so far by outcome. Lower chart: each trial at its contact.");
}

void add_displacements(ReportPage& page, const fs::path& folder, const CampaignReport& input) {
  const std::vector<double>& forces = input.campaign.plan().normal_forces;
  Eigen::Matrix3Xd places(3, static_cast<Eigen::Index>(input.model.contacts.size()));
  for (Eigen::Index i = 0; i < places.cols(); ++i)
    places.col(i) = input.model.contacts[static_cast<std::size_t>(i)].position;
  page.add_heading("Displacements");
  for (const std::size_t level : {std::size_t{0}, forces.size() - 1}) {
    const Eigen::VectorXd depths = displacements(input, static_cast<int>(level));
    const bool any = (depths.array() > 0 && depths.array().isFinite()).any();
    if (!any || (level > 0 && forces.size() == 1)) continue;
    const std::string file = fmt::format("displacements-{}.png", level);
    const std::string title = fmt::format("Displacement under {:.3g} N", forces[level]);
    pictures::draw_displacements(folder / file, input.model.surface, places, depths, title);
    page.add_picture(file, title +
                               " along the normal. The diameter of a circle is proportional to the "
                               "displacement (thesis, Figure 4.10).");
  }
}

void add_samples(ReportPage& page, const fs::path& folder, const CampaignReport& input) {
  page.add_heading("Samples");
  page.add_paragraph(
      "Each arrow is a measured force at the displacement that it caused (thesis, Figure 4.12). "
      "Shown are the contacts whose fields fit best, as the median, and worst.");
  for (const std::size_t i : shown_contacts(input.model)) {
    const std::string file = fmt::format("contact-{}.png", input.model.contacts[i].id);
    draw_contact_field(folder / file, input.model, input.acquisition, i);
    page.add_picture(file, fmt::format("Contact {}", input.model.contacts[i].id));
  }
}

void add_errors(ReportPage& page, const fs::path& folder, const CampaignReport& input) {
  page.add_heading("Errors");
  std::vector<std::vector<std::string>> rows;
  if (input.queries) {
    rows.push_back({fmt::format("Against {} known forces, RMS", input.queries->count),
                    force_in_words(input.queries->rms)});
  }
  if (input.left_out) {
    rows.push_back(
        {"Each contact predicted without itself, RMS", force_in_words(input.left_out->rms)});
    rows.push_back({"of these, inside", force_in_words(input.left_out->interior_rms)});
    rows.push_back({"of these, at the border", force_in_words(input.left_out->border_rms)});
  } else {
    page.add_paragraph("The model has too few contacts to predict one from the others.");
  }
  page.add_table({}, rows);
  if (input.left_out) {
    draw_leave_one_out(folder / "errors.png", input.model, *input.left_out);
    page.add_picture("errors.png", "Error of each contact when it is predicted from the others.");
  }
}

void add_contact_table(ReportPage& page, const CampaignReport& input) {
  page.add_heading("Contacts");
  std::vector<std::vector<std::string>> rows;
  for (std::size_t i = 0; i < input.model.contacts.size(); ++i) {
    const haptics::ContactModel& contact = input.model.contacts[i];
    const auto samples = input.acquisition.samples_of(input.acquisition.find(contact.id).value());
    const auto slipped =
        std::count_if(samples.begin(), samples.end(), [](const auto& s) { return s.slipped; });
    rows.push_back({std::to_string(contact.id), std::to_string(samples.size()),
                    std::to_string(slipped),
                    haptics::has_unknown_friction(contact) ? std::string("unknown")
                    : contact.friction_error
                        ? fmt::format("{:.3f} ± {:.3f}", contact.friction, *contact.friction_error)
                        : fmt::format("{:.3f}", contact.friction),
                    force_in_words(contact.rms),
                    input.left_out ? force_in_words(input.left_out->per_contact[i].rms)
                                   : std::string("unknown")});
  }
  page.add_table(
      {"contact", "samples", "slipped", "friction coefficient", "RMS of fit", "RMS left out"},
      rows);
}

/// A contact is predicted from at least three others.
constexpr std::size_t kLeastLeftOut = 4;

struct ReportCall {
  fs::path store, model, queries, record, output;
};

/// All files that a report of this campaign can have, of an earlier model also.
std::vector<fs::path> report_files(const probing::Campaign& campaign) {
  std::vector<fs::path> files{"index.html",    "timeline.png",     "errors.png",
                              "touch.png",     "gravity-0.png",    "gravity-1.png",
                              "gravity-2.png", "force-errors.png", kStiffnessPicture};
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
  add_stiffness(page, folder, input.model.surface, input.stiffness);
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
  figures["stiffness"] = stiffness_figures(input.stiffness);
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
      .stiffness = {},
      .left_out = {},
      .queries = {},
      .session = {}};
  report.trials = campaign.trials(report.campaign.plan().contacts);
  report.findings = findings_of(campaign, report.campaign.plan(), report.options);
  if (report.trials.empty())
    throw InvalidInput(store.string() + ": has no trial yet; there is nothing to report");
  report.stiffness = reported_stiffness(report.acquisition, report.model.surface,
                                        {.position = report.options.program.position_noise,
                                         .force = report.options.program.force_noise});
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
  add_required(*command, "ACQUISITION", call->store, "Store of the campaign (acquisition.db)");
  add_required(*command, "MODEL", call->model, "Model folder that was fitted to it");
  command->add_option("--queries", call->queries,
                      "Known forces to compare with (queries.csv of 'palpate probe truth')");
  command->add_option(
      "--record", call->record,
      "Record of the arm (session.arm of 'palpate probe run --record'): adds a "
      "touch, the compensation of gravity and, if the arm has a sensor of its own for them, "
      "the errors of forces");
  add_required(*command, "-o,--output", call->output, "Folder for index.html and its pictures");
  command->footer("Example:\n  palpate probe report acquisition.db model/ -o report/");
  command->callback([call, &settings] { report(settings, *call); });
}

}  // namespace palpate::apps
