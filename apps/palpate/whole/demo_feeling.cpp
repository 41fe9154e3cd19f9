// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/demo.h"

#include <algorithm>
#include <chrono>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/trajectory_csv.h"
#include "palpate/probing/acquisition_csv.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/csv.h"
#include "shared/model_pictures.h"
#include "shared/played_model.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

/// Errors of the friction coefficients relative to the true ones in `truth_contacts.csv`.
geometry::ErrorStatistics friction_errors(const haptics::Model& model, const fs::path& truth) {
  const std::string_view columns[] = {"id", "mu"};
  probing::CsvReader row(truth, columns);
  std::vector<double> errors;
  while (row.next()) {
    const auto contact = std::find_if(model.contacts.begin(), model.contacts.end(),
                                      [&](const auto& c) { return c.id == row.integer(0); });
    if (contact != model.contacts.end()) errors.push_back(contact->friction - row.number(1));
  }
  return geometry::error_statistics(std::move(errors));
}

/// Plays the bundled trajectory; false if a second run gives a different trace.
bool play_twice(const haptics::Playback& playback,
                const std::vector<haptics::TrajectoryPoint>& trajectory, const fs::path& output) {
  const std::vector<haptics::TracePoint> trace = haptics::play(playback, trajectory);
  const std::vector<haptics::TracePoint> again = haptics::play(playback, trajectory);
  haptics::write_trace(output / "trace.csv", trace);
  draw_trace(output / "forces.png", trace, "What a user feels along the bundled trajectory");
  return std::equal(
      trace.begin(), trace.end(), again.begin(), again.end(),
      [](const auto& a, const auto& b) { return a.force == b.force && a.force.allFinite(); });
}

Json feel(const std::string& name, const fs::path& data, const fs::path& output) {
  const probing::CheckedAcquisition acquisition =
      probing::read_acquisition_csv(data / name / "contacts.csv", data / name / "samples.csv");
  probing::write_acquisition(output / "acquisition.db", acquisition);

  const auto start = std::chrono::steady_clock::now();
  Progress progress("fitting " + name);
  const haptics::BuildResult built = haptics::build_model(
      acquisition, geometry::read_mesh(data / name / "surface.ply"),
      {.fit = {}, .progress = [&](haptics::BuildStage stage, int done, int total) {
         if (stage == haptics::BuildStage::fields) progress.show(done, total);
       }});
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  const haptics::Model& model = built.model;
  haptics::write_model(output / "model", model);

  std::vector<double> rms;
  for (const haptics::ContactModel& contact : model.contacts) rms.push_back(contact.rms);
  const haptics::QueryErrors queries =
      haptics::evaluate_queries(model, haptics::read_queries(data / name / "queries.csv"));
  const haptics::LeaveOneOut left_out = haptics::leave_one_out(model, acquisition);

  const haptics::Playback playback(model);
  const std::vector<haptics::TrajectoryPoint> trajectory =
      haptics::read_trajectory(data / "trajectory.csv");
  const bool same = play_twice(playback, trajectory, output);
  const StepTimes times = time_steps(playback, trajectory);

  draw_model_contacts(output / "contacts.png", model,
                      "Contacts on the " + name + ", their cells and triangles");
  const std::size_t shown = median_contact(model);
  draw_contact_field(output / "contact.png", model, acquisition, shown);

  return {{"name", name},
          {"contacts", model.contacts.size()},
          {"samples", acquisition.samples().size()},
          {"fit_seconds", elapsed.count()},
          {"fit_rms", geometry::error_statistics(rms).median},
          {"queries_rms", queries.rms},
          {"queries_median", queries.median},
          {"leave_one_out_rms", left_out.rms},
          {"friction_error", friction_errors(model, data / name / "truth_contacts.csv").median},
          {"us_per_step", times.all.median},
          {"us_per_slip", times.slip.median},
          {"same_and_finite", same}};
}

}  // namespace

Json demo_feeling(const fs::path& data, const fs::path& output) {
  Json figures = Json::array();
  for (const std::string name : {"sheet", "sheet_block"})
    figures.push_back(feel(name, data, output / name));
  return figures;
}

}  // namespace palpate::apps
