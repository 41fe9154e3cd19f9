// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/documents/document.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/haptics/bake_model.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/known_forces.h"
#include "palpate/probing/specimen_file.h"
#include "palpate/probing/specimen_trials.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/output_checks.h"
#include "shared/progress.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

using Eigen::Vector3d;

constexpr std::size_t kToldFailures = 10;  // one by one, on standard error

struct BakeCall {
  fs::path specimen, output, acquisition;
  probing::PlanOptions plan;
  probing::KnownForceOptions queries;
};

std::unique_ptr<probing::Specimen> read_specimen(const fs::path& path) {
  try {
    return probing::parse_specimen(documents::read_json_text(path), path.string());
  } catch (const SolverError& error) {  // of the object at rest, before the tip comes
    throw SolverError(path.string() + ": " + error.what());
  }
}

std::string in_newton(const Vector3d& force) {
  return fmt::format("({:.3f}, {:.3f}, {:.3f}) N", force.x(), force.y(), force.z());
}

void tell_failures(const probing::SpecimenTrials& trials, const probing::KnownForces& known) {
  for (std::size_t i = 0; i < std::min(trials.failed.size(), kToldFailures); ++i) {
    const probing::FailedTrial& failed = trials.failed[i];
    spdlog::warn(
        "contact {} has no sample under {}{}: {}", failed.contact, in_newton(failed.trial.force),
        failed.not_tried > 0 ? fmt::format(" and {} forces with it or above", failed.not_tried)
                             : "",
        failed.trial.reason);
  }
  if (trials.failed.size() > kToldFailures) {
    spdlog::warn("{} more forces have no sample; --json lists all",
                 trials.failed.size() - kToldFailures);
  }
  if (!known.unanswered.empty()) {
    spdlog::warn("{} of {} forces to compare with have no equilibrium and are left out; first: {}",
                 known.unanswered.size(), known.unanswered.size() + known.forces.size(),
                 known.unanswered.front().reason);
  }
}

Json failures_of(const probing::SpecimenTrials& trials) {
  Json failed = Json::array();
  for (const probing::FailedTrial& one : trials.failed) {
    const Vector3d& force = one.trial.force;
    failed.push_back({{"contact", one.contact},
                      {"force", numbers_in(force)},
                      {"not_tried", one.not_tried},
                      {"reason", one.trial.reason}});
  }
  return failed;
}

probing::KnownForces compute_queries(const probing::Specimen& specimen, const BakeCall& call) {
  probing::KnownForceOptions options = call.queries;
  options.max_force = call.plan.max_force;
  options.progress = shown_as("computing forces to compare with");
  return with_names({{"known_forces()", call.specimen.string()}},
                    [&] { return probing::known_forces(specimen, options); });
}

probing::SpecimenTrials compute_samples(const probing::Specimen& specimen,
                                        const probing::ContactPlan& plan, const BakeCall& call) {
  try {
    return probing::try_specimen(specimen, plan, {.progress = shown_as("computing samples")});
  } catch (const SolverError& error) {
    throw SolverError(call.specimen.string() + ": " + error.what());
  }
}

haptics::BuildResult build(const probing::CheckedAcquisition& acquisition,
                           const geometry::TriangleMesh& surface, const BakeCall& call) {
  Progress progress("fitting");
  haptics::BuildOptions options = haptics::exact_samples(call.plan.max_force);
  // The fit of friction takes almost no time.
  options.progress = [&](haptics::BuildStage stage, int done, int total) {
    if (stage == haptics::BuildStage::fields) progress.show(done, total);
  };
  return with_names({{"build_model()", call.specimen.string()}},
                    [&] { return haptics::build_model(acquisition, surface, options); });
}

std::optional<haptics::QueryErrors> errors_of(const haptics::Model& model,
                                              const probing::KnownForces& known) {
  if (known.forces.empty()) return std::nullopt;
  std::vector<haptics::Query> queries;
  for (const probing::KnownForce& one : known.forces)
    queries.push_back({one.contact, one.displacement, one.force});
  return haptics::evaluate_queries(model, queries);
}

void report(const Settings& settings, const BakeCall& call, const probing::SpecimenTrials& trials,
            const haptics::BuildResult& built, const std::optional<haptics::QueryErrors>& errors) {
  std::vector<double> rms;
  for (const haptics::ContactModel& contact : built.model.contacts) rms.push_back(contact.rms);
  const geometry::ErrorStatistics fits = geometry::error_statistics(rms);
  Json queries;
  std::string prose;
  if (errors) {
    queries = {{"count", errors->count},
               {"rms", errors->rms},
               {"median", errors->median},
               {"p90", errors->p90}};
    prose = fmt::format(
        "\nAgainst {} known forces between contacts: RMS {}, median {}, 90 % within {}",
        errors->count, newtons(errors->rms), newtons(errors->median), newtons(errors->p90));
  }
  print(
      settings,
      {{"contacts", built.model.contacts.size()},
       {"samples", trials.acquisition.samples.size()},
       {"equilibria", trials.equilibria},
       {"failed", failures_of(trials)},
       {"isolated", built.isolated},
       {"rms", {{"median", fits.median}, {"p90", fits.p90}, {"max", fits.max}}},
       {"queries", queries},
       {"file", call.output.string()}},
      fmt::format("{} contacts with {} samples, from {} equilibria; RMS of a contact {} in the "
                  "median, at most {}{}\nWritten to {}",
                  built.model.contacts.size(), trials.acquisition.samples.size(), trials.equilibria,
                  newtons(fits.median), newtons(fits.max), prose, call.output.string()));
}

void bake(const Settings& settings, const BakeCall& call) {
  check_outputs({call.specimen}, {call.output, call.acquisition});
  if (!call.acquisition.empty()) probing::check_acquisition_output(call.acquisition);
  check_model_output({call.specimen}, call.output);
  const auto specimen = read_specimen(call.specimen);
  const probing::ContactPlan plan = haptics::plan_bake(*specimen, call.plan);
  const probing::KnownForces known = compute_queries(*specimen, call);
  probing::SpecimenTrials trials = compute_samples(*specimen, plan, call);
  tell_failures(trials, known);
  trials.acquisition.meta["specimen"] = call.specimen.filename().string();
  const probing::CheckedAcquisition acquisition(trials.acquisition);
  if (!call.acquisition.empty()) probing::write_acquisition(call.acquisition, acquisition);
  haptics::BuildResult built = build(acquisition, specimen->surface(), call);
  built.model.made["program"] = "palpate " PALPATE_VERSION;
  built.model.made["specimen"] = call.specimen.filename().string();
  haptics::write_model(call.output, built.model);
  for (const long long id : built.isolated) {
    spdlog::warn(
        "contact {} is in no triangle of contacts: there are too few around it; choose a "
        "smaller --spacing",
        id);
  }
  report(settings, call, trials, built, errors_of(built.model, known));
}

}  // namespace

void add_bake(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<BakeCall>();
  call->queries.queries = 100;
  CLI::App* command = app.add_subcommand(
      "bake", "Make a model of a simulated object, such as one of finite elements");
  add_required(*command, "SPECIMEN", call->specimen,
               "Simulated object (JSON or YAML; docs/probing.md)");
  add_required(*command, "-o,--output", call->output, "Model folder to write");
  constexpr std::array<std::string_view, 4> kOfPlan{"spacing", "contacts", "directions",
                                                    "max_force"};
  add_fields(*command, fields_of(call->plan), kOfPlan);
  constexpr std::array<std::string_view, 4> kOfQueries{"queries", "margin", "least_force", "seed"};
  add_fields(*command, fields_of(call->queries), kOfQueries);
  command->add_option(
      "--acquisition", call->acquisition,
      "Also write the samples to a database (acquisition.db), for palpate fit and evaluate");
  command->footer(
      "Nothing is measured: displacements are computed, and friction is that of the specimen. "
      "Contacts are computed in parallel (--threads).\n"
      "Example:\n  palpate bake block.json -o model/");
  command->callback([call, &settings] { bake(settings, *call); });
}

}  // namespace palpate::apps
