// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/identify.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/plausible.h"

namespace palpate::apps {
namespace {

using Json = nlohmann::ordered_json;

struct IdentifyCall {
  std::filesystem::path acquisition;
  std::string model = "strip";
  std::optional<double> tool_radius;
  haptics::IdentifyOptions options;
};

Json vector(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

/// Settings of a strip model; only a strip has a position and a direction.
Json place(const haptics::StripModel& strip) {
  return {{"origin", vector(strip.origin)},
          {"axis", vector(strip.axis)},
          {"across", vector(strip.across)}};
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

void report(const Settings& settings, const IdentifyCall& call,
            const haptics::Identification& found, Json figures, const Json& warnings) {
  Json parameters = Json::array(), contacts = Json::array();
  std::string prose;
  for (const haptics::ParameterEstimate& parameter : found.parameters) {
    parameters.push_back({{"name", parameter.name},
                          {"unit", parameter.unit},
                          {"status", haptics::to_string(parameter.status)},
                          {"value", number_or_null(parameter.value)},
                          {"standard_error", number_or_null(parameter.standard_error)}});
    prose += describe(parameter);
  }
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
  figures["parameters"] = parameters;
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

void identify(const Settings& settings, const IdentifyCall& call) {
  if (call.model == "half-space" && !call.tool_radius) {
    throw InvalidInput(
        "palpate identify: --model half-space needs the radius of the tool; give --tool-radius");
  }
  Json warnings = Json::array();
  const probing::CheckedAcquisition acquisition =
      read_plausible_acquisition(call.acquisition, warnings);
  if (call.model == "strip") {
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
  command->add_option("ACQUISITION", call->acquisition, "Measurements (acquisition.db)")
      ->required();
  command
      ->add_option(
          "--model", call->model,
          "strip: a sheet stretched between two supports; half-space: a large elastic body")
      ->check(one_of({"strip", "half-space"}))
      ->capture_default_str();
  command
      ->add_option("--tool-radius", call->tool_radius,
                   "For the half-space: radius of the tool's flat end [mm]")
      ->check(within(above(0)));
  add_fields(*command, fields_of(call->options));
  command->footer(
      "Parameters of the strip: tension and axial stiffness (force per strain) of the sheet, "
      "positions of its supports along the axis, lateral stiffness against motion across the "
      "strip, compliance of the skin under the tool, slope and curvature of tension and stiffness "
      "across the sheet, and direction of the axis. Parameters of the half-space: Young's modulus "
      "and Poisson's ratio.\n"
      "Examples:\n  palpate identify acquisition.db --model strip\n"
      "  palpate identify acquisition.db --model half-space --tool-radius 3");
  command->callback([call, &settings] { identify(settings, *call); });
}

}  // namespace palpate::apps
