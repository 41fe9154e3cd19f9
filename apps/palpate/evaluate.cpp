// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "command_line.h"
#include "palpate/error.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/trajectory_csv.h"
#include "palpate/probing/acquisition_store.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct EvaluateCall {
  fs::path model, queries, acquisition;
};

void evaluate(const Settings& settings, const EvaluateCall& call) {
  if (call.queries.empty() && call.acquisition.empty()) {
    throw InvalidInput(
        "palpate evaluate: nothing to compare with. Pass --queries, --leave-one-out or both.");
  }
  const haptics::Model model = haptics::read_model(call.model);
  Json figures;
  std::string prose;
  if (!call.queries.empty()) {
    const haptics::QueryErrors errors =
        haptics::evaluate_queries(model, haptics::read_queries(call.queries));
    figures["queries"] = {{"count", errors.count},
                          {"rms", errors.rms},
                          {"median", errors.median},
                          {"p90", errors.p90}};
    prose +=
        fmt::format("Against {} queries: RMS {:.4f} N, median {:.4f} N, 90 % within {:.4f} N\n",
                    errors.count, errors.rms, errors.median, errors.p90);
  }
  if (!call.acquisition.empty()) {
    const haptics::LeaveOneOut errors =
        haptics::leave_one_out(model, probing::read_acquisition(call.acquisition));
    Json per_contact = Json::array();
    for (const haptics::ContactError& e : errors.per_contact) {
      per_contact.push_back({{"contact", e.contact}, {"rms", e.rms}});
      prose += fmt::format("  contact {} predicted from its neighbours: RMS {:.4f} N\n", e.contact,
                           e.rms);
    }
    figures["leave_one_out"] = {{"rms", errors.rms}, {"per_contact", per_contact}};
    prose += fmt::format("Each contact predicted without itself: RMS {:.4f} N over {} contacts\n",
                         errors.rms, errors.per_contact.size());
  }
  prose.pop_back();
  print(settings, figures, prose);
}

}  // namespace

void add_evaluate(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<EvaluateCall>();
  CLI::App* command =
      app.add_subcommand("evaluate", "How far a model's forces are from known ones");
  command->add_option("MODEL", call->model, "Model folder")->required();
  command->add_option(
      "--queries", call->queries,
      "Known forces: cx,cy,cz,dx,dy,dz,fx,fy,fz (contact, displacement, force on the object)");
  command->add_option("--leave-one-out", call->acquisition,
                      "Acquisition the model was fitted to: predict each contact from the others");
  command->footer(
      "RMS is the root of the mean squared length of the error vector, in N.\n"
      "Example:\n  palpate evaluate model/ --queries queries.csv --leave-one-out acquisition.db");
  command->callback([call, &settings] { evaluate(settings, *call); });
}

}  // namespace palpate::apps
