// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/identify.h"
#include "palpate/documents/document.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/haptics/identify_solid.h"
#include "palpate/probing/fingerprint.h"
#include "palpate/probing/material_text.h"
#include "palpate/probing/specimen_file.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/output_checks.h"
#include "shared/plausible.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

struct IdentifyCall {
  fs::path acquisition;
  std::string model = "strip";
  std::optional<double> tool_radius;
  std::optional<fs::path> solid;  ///< specimen file of a solid of finite elements
  std::optional<fs::path> card;   ///< file to write
  haptics::SolidOptions solid_options;
  haptics::IdentifyOptions options;
};

/// Settings of a strip model; only a strip has a position and a direction.
Json place(const haptics::StripModel& strip) {
  return {{"origin", numbers_in(strip.origin)},
          {"axis", numbers_in(strip.axis)},
          {"across", numbers_in(strip.across)}};
}

const char* verdict_in_words(haptics::Verdict verdict) {
  switch (verdict) {
    case haptics::Verdict::describes:
      return "This parametric model describes the object";
    case haptics::Verdict::does_not_describe:
      return "This parametric model does not describe the object";
    case haptics::Verdict::not_testable:
      return "It is undecided whether this parametric model describes the object: the noise is "
             "unknown or too large, or there are too few samples";
    case haptics::Verdict::not_converged:
      return "The search did not converge: do not use the parameters";
  }
  return "";
}

std::string describe(const haptics::ParameterEstimate& parameter) {
  switch (parameter.status) {
    case haptics::ParameterStatus::determined:
      return fmt::format("  {}: {:.6g} +- {:.2g} {}\n", parameter.name, *parameter.value,
                         *parameter.standard_error, parameter.unit);
    case haptics::ParameterStatus::at_bound:
      return fmt::format("  {}: not determined by these measurements; at its bound {:.6g} {}\n",
                         parameter.name, *parameter.value, parameter.unit);
    case haptics::ParameterStatus::undetermined:
      return fmt::format("  {}: not determined by these measurements\n", parameter.name);
  }
  return "";
}

Json listed(const std::vector<haptics::ParameterEstimate>& parameters) {
  Json result = Json::array();
  for (const haptics::ParameterEstimate& parameter : parameters)
    result.push_back({{"name", parameter.name},
                      {"unit", parameter.unit},
                      {"status", haptics::to_string(parameter.status)},
                      {"value", number_or_null(parameter.value)},
                      {"standard_error", number_or_null(parameter.standard_error)}});
  return result;
}

/// Pairs of parameters that the data hardly tell apart.
std::string describe_correlations(const haptics::Identification& found) {
  constexpr double kStrong = 0.9;
  std::string result;
  for (Eigen::Index i = 0; i < found.correlations.rows(); ++i) {
    for (Eigen::Index j = 0; j < i; ++j) {
      if (!(std::abs(found.correlations(i, j)) > kStrong)) continue;
      result +=
          fmt::format("  the errors of {} and {} have a correlation of {:.2f}\n",
                      found.parameters[static_cast<std::size_t>(j)].name,
                      found.parameters[static_cast<std::size_t>(i)].name, found.correlations(i, j));
    }
  }
  return result;
}

void report(const Settings& settings, const IdentifyCall& call,
            const haptics::Identification& found, Json figures, const Json& warnings,
            const std::string& remarks = {}) {
  Json contacts = Json::array();
  std::string prose;
  for (const haptics::ParameterEstimate& parameter : found.parameters) prose += describe(parameter);
  prose += describe_correlations(found) + remarks;
  int disagreeing = 0;
  for (const haptics::ContactAgreement& contact : found.contacts) {
    contacts.push_back({{"contact", contact.contact},
                        {"chi2", contact.chi2},
                        {"pairs", contact.pairs},
                        {"outliers", contact.outliers}});
    disagreeing += contact.chi2 > call.options.max_chi2 ? 1 : 0;
  }
  figures["model"] = call.model;
  figures["verdict"] = haptics::to_string(found.verdict);
  figures["chi2"] = number_or_null(found.chi2);
  figures["rms"] = found.rms;
  figures["explained"] = found.explained;
  figures["pairs"] = found.pairs;
  figures["outliers"] = found.outliers;
  figures["displacement_noise"] = found.displacement_noise;
  figures["force_noise"] = found.force_noise;
  figures["parameters"] = listed(found.parameters);
  figures["correlations"] = rows_in(found.correlations);
  figures["per_contact"] = contacts;
  figures["warnings"] = warnings;
  prose += fmt::format(
      "chi^2 per degree of freedom {}, RMS {:.4f} mm over {} pairs, {:.1f} % of the squared "
      "displacements explained, {} outliers; {} of {} contacts disagree.\n{}.",
      found.chi2 ? fmt::format("{:.3g}", *found.chi2) : "unknown", found.rms, found.pairs,
      100 * std::max(0.0, found.explained), found.outliers, disagreeing, found.contacts.size(),
      verdict_in_words(found.verdict));
  print(settings, figures, prose);
}

/// Returns the origin of the material, for the specimen file.
Json provenance(const IdentifyCall& call, const haptics::IdentifiedSolid& found,
                const probing::Acquisition& acquisition) {
  return {{"parameters", listed(found.report.parameters)},
          {"correlations", rows_in(found.report.correlations)},
          {"verdict", haptics::to_string(found.report.verdict)},
          {"chi2", number_or_null(found.report.chi2)},
          {"rms", found.report.rms},
          {"pairs", found.report.pairs},
          {"measurements", call.acquisition.filename().string()},
          {"fingerprint", probing::fingerprint(acquisition)},
          {"palpate", PALPATE_VERSION}};
}

std::string mesh_errors_in_words(const haptics::IdentifiedSolid& found) {
  std::vector<std::string> errors;
  for (std::size_t k = 0; k < found.mesh_errors.size(); ++k) {
    const haptics::ParameterEstimate& parameter = found.report.parameters[k];
    if (std::isfinite(found.mesh_errors[k]))
      errors.push_back(fmt::format("{} {:+.1f} %", parameter.name,
                                   100 * found.mesh_errors[k] / *parameter.value));
  }
  if (errors.empty()) return {};
  return fmt::format("  corrected for the error of the mesh: {}\n", fmt::join(errors, ", "));
}

/// Warns of data that the estimate does not use, and of parameters that it does not determine.
void warn_of_gaps(const haptics::IdentifiedSolid& found, const haptics::SolidOptions& options,
                  Json& warnings) {
  if (!found.left_out.empty()) {
    warn(warnings, "left_out",
         fmt::format("the tip cannot reach {} contacts on this solid; they are left out: {}",
                     found.left_out.size(), fmt::join(found.left_out, ", ")));
  }
  if (found.unanswered > 0) {
    warn(warnings, "unanswered",
         fmt::format("the solid has no equilibrium under {} of the forces; they are left out",
                     found.unanswered));
  }
  if (!found.mesh_limited.empty()) {
    warn(warnings, "mesh_limited",
         fmt::format(
             "with the error of this mesh, the measurements do not determine: {}; use a finer mesh",
             fmt::join(found.mesh_limited, ", ")));
  }
  const bool mesh_known =
      std::ranges::any_of(found.mesh_errors, [](double error) { return std::isfinite(error); });
  if (options.mesh_pairs > 0 && !mesh_known && found.mesh_limited.empty()) {
    warn(warnings, "mesh",
         "the error of the mesh is not known, since no press has an equilibrium on a finer one; "
         "errors are stated as if the mesh were exact");
  }
}

void identify_solid(const Settings& settings, const IdentifyCall& call,
                    const probing::CheckedAcquisition& acquisition, Json warnings) {
  const std::string text = documents::read_json_text(*call.solid);
  const probing::FiniteElementObject object =
      probing::parse_finite_elements(text, call.solid->string());
  if (call.card) check_outputs({call.acquisition, *call.solid, object.mesh_file}, {*call.card});
  haptics::SolidOptions solid = call.solid_options;
  solid.progress = shown_as("identifying the material");
  const haptics::IdentifiedSolid found =
      haptics::identify_solid(acquisition, object, solid, call.options);
  warn_of_gaps(found, call.solid_options, warnings);
  Json figures{{"mesh_errors", found.mesh_errors},
               {"mesh_limited", found.mesh_limited},
               {"left_out", found.left_out}};
  if (call.card) {
    Json card = Json::parse(
        probing::with_material(text, call.solid->string(), found.object, found.presses));
    card["identified"].update(provenance(call, found, acquisition.records()));
    write_file(*call.card, [&](std::ostream& out) { out << card.dump(2) << "\n"; });
    figures["file"] = call.card->string();
  }
  report(settings, call, found.report, figures, warnings, mesh_errors_in_words(found));
}

void identify(const Settings& settings, IdentifyCall call) {
  if (call.model == "half-space" && !call.tool_radius) {
    throw InvalidInput(
        "palpate identify: --model half-space needs the radius of the tool; give --tool-radius");
  }
  if (call.card && !call.solid) {
    throw InvalidInput(
        "palpate identify: --output is a specimen file with the material that was found; it needs "
        "--finite-elements");
  }
  Json warnings = Json::array();
  const probing::CheckedAcquisition acquisition =
      read_plausible_acquisition(call.acquisition, warnings);
  if (call.solid) {
    call.model = "finite-elements";
    identify_solid(settings, call, acquisition, warnings);
  } else if (call.model == "strip") {
    const haptics::IdentifiedStrip found = haptics::identify_strip(acquisition, call.options);
    report(settings, call, found.report, place(found.model), warnings);
  } else {
    report(settings, call,
           haptics::identify_half_space(acquisition, *call.tool_radius, call.options).report,
           {{"tool_radius", *call.tool_radius}}, warnings);
  }
}

}  // namespace

void add_identify(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<IdentifyCall>();
  CLI::App* command = app.add_subcommand(
      "identify", "Estimate elastic parameters of an object, with errors, from measurements");
  add_required(*command, "ACQUISITION", call->acquisition, "Measurements (acquisition.db)");
  add_word(*command, "--model", call->model, {"strip", "half-space"},
           "strip: a sheet stretched between two supports; half-space: a large elastic body")
      ->capture_default_str();
  add_number(*command, "--tool-radius", call->tool_radius, above(0),
             "For the half-space: radius of the tool's flat end [mm]");
  CLI::Option* solid = command->add_option("--finite-elements", call->solid,
                                           "Specimen file (JSON or YAML) of a solid of finite "
                                           "elements: shear moduli of its regions, bulk "
                                           "modulus, pre-stretch and friction are estimated");
  solid->excludes("--model")->excludes("--tool-radius");
  add_fields_of(*solid, *command, fields_of(call->solid_options));
  command->add_option("-o,--output", call->card,
                      "With --finite-elements: the specimen file with the material that was found, "
                      "its errors and where it comes from");
  add_fields(*command, fields_of(call->options));
  command->footer(
      "Parameters of the strip: tension and axial stiffness (force per strain) of the sheet, "
      "positions of its supports along the axis, lateral stiffness against motion across the "
      "strip, compliance of the skin under the tool, slope and curvature of tension and stiffness "
      "across the sheet, and direction of the axis. Parameters of the half-space: Young's modulus "
      "and Poisson's ratio.\n"
      "Examples:\n  palpate identify acquisition.db --model strip\n"
      "  palpate identify acquisition.db --model half-space --tool-radius 3\n"
      "  palpate identify acquisition.db --finite-elements solid.json -o identified.json");
  command->callback([call, &settings] { identify(settings, *call); });
}

}  // namespace palpate::apps
