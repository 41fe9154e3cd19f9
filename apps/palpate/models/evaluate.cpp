// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "palpate/core/error.h"
#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/acquisition_store.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/model_pictures.h"
#include "shared/output_checks.h"
#include "shared/plausible.h"
#include "shared/progress.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

// Smallest share of the squared forces that a model of the same object explains.
constexpr double kSameForces = 0.5;
// Forces that are this many times as large, or as small, seem to have another unit.
constexpr double kOtherForceUnit = 3;

struct EvaluateCall {
  fs::path model, queries, acquisition, picture;
  haptics::QueryOptions query_options;
  haptics::LeaveOneOutOptions leave_one_out;
};

haptics::LeaveOneOut predict(const haptics::Model& model, const EvaluateCall& call) {
  const probing::CheckedAcquisition acquisition = probing::read_acquisition(call.acquisition);
  haptics::LeaveOneOutOptions options = call.leave_one_out;
  options.progress = shown_as("predicting");
  return haptics::leave_one_out(model, acquisition, options);
}

Json to_json(const std::optional<haptics::StatedErrors>& stated) {
  if (!stated) return {};
  return {{"rms", stated->rms}, {"ratio", stated->ratio}};
}

std::string stated_in_words(const std::optional<haptics::StatedErrors>& stated) {
  if (!stated) return "the model states no errors";
  return fmt::format(
      "stated {} (RMS); each error divided by the one stated for it: {:.2f} (RMS), 1 is ideal",
      newtons(stated->rms), stated->ratio);
}

Json to_json(const haptics::LeaveOneOut& errors) {
  Json per_contact = Json::array(), suggested = Json::array();
  for (const haptics::ContactError& e : errors.per_contact) {
    per_contact.push_back({{"contact", e.contact},
                           {"rms", e.rms},
                           {"samples", e.samples},
                           {"at_border", e.at_border},
                           {"spread", e.spread},
                           {"expected", number_or_null(e.expected)},
                           {"stated", to_json(e.stated)}});
  }
  for (const haptics::SuggestedContact& s : errors.suggested) {
    suggested.push_back({{"position", numbers_in(s.position)}, {"expected", s.expected}});
  }
  return {{"rms", errors.rms},
          {"interior_rms", number_or_null(errors.interior_rms)},
          {"border_rms", number_or_null(errors.border_rms)},
          {"stated", to_json(errors.stated)},
          {"per_contact", per_contact},
          {"suggested", suggested}};
}

std::string to_prose(const haptics::LeaveOneOut& errors) {
  const auto if_known = [](std::optional<double> force) {
    return force ? newtons(*force) : std::string("unknown");
  };
  std::vector<std::string> lines;
  std::vector<double> sizes;
  for (const haptics::ContactError& e : errors.per_contact) {
    lines.push_back(fmt::format(
        "  contact {} ({}) predicted from its neighbours: RMS {}, expected {}; the neighbours "
        "disagree by {}\n",
        e.contact, e.at_border ? "border" : "inside", newtons(e.rms), if_known(e.expected),
        newtons(e.spread)));
    sizes.push_back(e.rms);
  }
  std::string prose = worst_lines(lines, sizes);
  prose += fmt::format(
      "Each contact predicted without itself: RMS {} over {} contacts; inside {}, at the border "
      "{}\n",
      newtons(errors.rms), errors.per_contact.size(), if_known(errors.interior_rms),
      if_known(errors.border_rms));
  prose += fmt::format("  with the noise of the samples: {}\n", stated_in_words(errors.stated));
  if (!errors.suggested.empty()) prose += "Suggested positions for further contacts:\n";
  for (const haptics::SuggestedContact& s : errors.suggested) {
    prose += fmt::format("  ({:.1f}, {:.1f}, {:.1f}): expected error {}\n", s.position.x(),
                         s.position.y(), s.position.z(), newtons(s.expected));
  }
  return prose;
}

haptics::QueryErrors compare_with_queries(const haptics::Model& model, const EvaluateCall& call) {
  return with_names({{"evaluate_queries()", call.queries.string()}}, [&] {
    return haptics::evaluate_queries(model, haptics::read_queries(call.queries),
                                     call.query_options);
  });
}

/// Warns of queries that seem to have other signs, units or columns.
void tell_odd_queries(const haptics::QueryErrors& errors, const fs::path& queries, Json& warnings) {
  const double scale = errors.scale.value_or(1), size = std::abs(scale);
  const bool is_scaled = scale < 0 || size > kOtherForceUnit || size < 1 / kOtherForceUnit;
  if (is_scaled && errors.explained_if_scaled.value_or(0) > kSameForces) {
    warn(
        warnings, "queries_scaled",
        fmt::format("{}: the forces are about {} times those of the model. A query has the "
                    "displacement of the tool [mm] and the force on the object [N]; other signs or "
                    "units would explain this",
                    queries.string(), std::round(1000 * scale) / 1000));
  } else if (errors.explained.value_or(1) < kSameForces) {
    warn(warnings, "queries_unexplained",
         fmt::format("{}: the model explains {:.0f} % of the squared forces. Other signs, units or "
                     "columns would explain this, or another object",
                     queries.string(), std::max(0.0, 100 * *errors.explained)));
  }
}

void evaluate(const Settings& settings, const EvaluateCall& call) {
  if (call.queries.empty() && call.acquisition.empty()) {
    throw InvalidInput(
        "palpate evaluate: nothing to compare with. Pass --queries, --leave-one-out or both.");
  }
  if (!call.picture.empty() && call.acquisition.empty()) {
    throw InvalidInput(
        "palpate evaluate: --picture draws the errors of --leave-one-out; pass that option too.");
  }
  check_outputs({call.model, call.queries, call.acquisition}, {call.picture});
  const haptics::Model model = haptics::read_model(call.model);
  Json figures, warnings = Json::array();
  std::string prose;
  if (!call.queries.empty()) {
    const haptics::QueryErrors errors = compare_with_queries(model, call);
    figures["queries"] = {{"count", errors.count},
                          {"rms", errors.rms},
                          {"median", errors.median},
                          {"p90", errors.p90},
                          {"stated", to_json(errors.stated)},
                          {"explained", number_or_null(errors.explained)}};
    prose += fmt::format("Against {} queries: RMS {}, median {}, 90 % within {}; {}\n",
                         errors.count, newtons(errors.rms), newtons(errors.median),
                         newtons(errors.p90), stated_in_words(errors.stated));
    tell_odd_queries(errors, call.queries, warnings);
  }
  if (!call.acquisition.empty()) {
    const haptics::LeaveOneOut errors = predict(model, call);
    figures["leave_one_out"] = to_json(errors);
    prose += to_prose(errors);
    if (!call.picture.empty()) draw_leave_one_out(call.picture, model, errors);
  }
  if (const int unknown = haptics::unknown_friction_count(model); unknown > 0) {
    prose += fmt::format(
        "The friction of {} is unknown; forces there are valid only while the tool does not slip\n",
        counted(unknown, "contact"));
  }
  figures["unknown_friction"] = haptics::unknown_friction_count(model);
  figures["warnings"] = warnings;
  prose.pop_back();
  print(settings, figures, prose);
}

}  // namespace

void add_evaluate(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<EvaluateCall>();
  CLI::App* command =
      app.add_subcommand("evaluate", "Compare the forces of a model with known ones");
  add_required(*command, "MODEL", call->model, "Model folder");
  command->add_option(
      "--queries", call->queries,
      "Known forces: cx,cy,cz,dx,dy,dz,fx,fy,fz (contact, displacement, force on the object)");
  command->add_option(
      "--leave-one-out", call->acquisition,
      "Acquisition that the model was fitted to: predict each contact from the others");
  add_fields(*command, fields_of(call->query_options));
  add_fields(*command, fields_of(call->leave_one_out));
  command->add_option("--picture", call->picture,
                      "Also draw the errors of --leave-one-out on the surface (PNG)");
  command->footer(
      "RMS is the root of the mean squared length of the error vector, in N. With --leave-one-out, "
      "it is compared with the error that kriging of the neighbours expects, and with "
      "the disagreement of the neighbours' forces. A contact at the border has neighbours on one "
      "side only. Offsets of contacts that were only pressed were estimated with all of them. "
      "Stated errors are what the model itself expects at each query or sample "
      "(docs/model-file.md). Where they are right, errors divided by them have an RMS of 1.\n"
      "Example:\n  palpate evaluate model/ --queries queries.csv --leave-one-out acquisition.db");
  command->callback([call, &settings] { evaluate(settings, *call); });
}

}  // namespace palpate::apps
