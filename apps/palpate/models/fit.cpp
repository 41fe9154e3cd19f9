// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "models/fit_record.h"
#include "models/fit_report.h"
#include "models/fit_shapes.h"
#include "models/fit_warnings.h"
#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/core/require.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/contact_surface.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/fingerprint.h"
#include "shared/inputs.h"
#include "shared/model_pictures.h"
#include "shared/plausible.h"
#include "shared/progress.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

struct FitCall {
  fs::path acquisition, surface, output, pictures, shapes;
  haptics::FitOptions fit;
  std::optional<haptics::BlendRule> blend_rule = haptics::BuildOptions{}.blend_rule;
  geometry::ContactTriangulationMethod triangulation =
      geometry::ContactTriangulationMethod::delaunay;
  std::optional<haptics::ModelEncoding> encoding;
  std::optional<double> budget_us;
  geometry::ReadOptions meshes;
  std::optional<double> force_noise;
  std::optional<double> probe_radius;  ///< [mm]
  bool estimate_offsets = true;
  bool rate = false;
  bool shared_local = false;
  int dense_samples = haptics::LocalGlobalOptions{}.dense_samples;
  bool resume = false;
  double max_distance = haptics::BuildOptions{}.max_distance;
  std::optional<int> max_left_out;
};

void draw(const FitCall& call, const haptics::Model& model,
          const probing::CheckedAcquisition& acquisition) {
  draw_model_contacts(call.pictures / "contacts.png", model,
                      "Contacts, their cells and triangulation");
  const auto worst = std::max_element(model.contacts.begin(), model.contacts.end(),
                                      [](const auto& a, const auto& b) { return a.rms < b.rms; });
  draw_contact_field(call.pictures / fmt::format("contact_{}.png", worst->id), model, acquisition,
                     static_cast<std::size_t>(worst - model.contacts.begin()));
}

/// The record beside the model: `OUTPUT.fits`.
fs::path record_file(const fs::path& output) {
  fs::path file = fs::absolute(output).lexically_normal();
  if (!file.has_filename()) file = file.parent_path();
  return file += ".fits";
}

/// All data and options that the fits depend on.
Json settings_of(const FitCall& call) {
  return {{"ACQUISITION", fingerprint(call.acquisition)},
          {"SURFACE", call.surface.empty() ? std::string() : fingerprint(call.surface)},
          {"--unit", call.meshes.unit ? Json(*call.meshes.unit) : Json()},
          {"--accuracy", call.fit.accuracy},
          {"--passive", haptics::to_string(call.fit.mode)},
          {"--force-noise", call.force_noise ? Json(*call.force_noise) : Json()},
          {"--touch-offset", call.estimate_offsets},
          {"--rate", call.rate},
          {"--max-distance", call.max_distance},
          {"--leave-out", call.max_left_out ? Json(*call.max_left_out) : Json()},
          {"--max-bases", call.fit.max_bases ? Json(*call.fit.max_bases) : Json()},
          {"--shared-local", call.shared_local},
          {"--dense-samples", call.shared_local ? Json(call.dense_samples) : Json()},
          {"version of palpate", PALPATE_VERSION}};
}

// Steady error of tangential forces over their noise, 0.01 N: with 0.01 N of it, 34 of 36 lower
// bounds hold that the virtual arm measured, with 0.015 N all; without, 15
// (docs/probing-validation.md).
constexpr double kSteadyErrorPerNoise = 1.5;

// A rendered force blends the fields of three contacts.
constexpr int kBlended = 3;

void limit_to_budget(FitCall& call) {
  if (!call.budget_us) return;
  const double bases = *call.budget_us / (kBlended * haptics::kEvaluationCost);
  if (!(bases >= 1)) {
    throw InvalidInput(
        fmt::format("--budget is {} us; one base for each of the {} contacts of a "
                    "blend already takes {:.2f} us; pass at least that",
                    *call.budget_us, kBlended, kBlended * haptics::kEvaluationCost));
  }
  const int most = static_cast<int>(std::min(bases, 1000.0));
  call.fit.max_bases =
      std::min(most, call.fit.max_bases.value_or(call.fit.mode == haptics::FitMode::convex
                                                     ? haptics::kMaxConvexBases
                                                     : haptics::kMaxLocalBases));
}

haptics::BuildResult build(const probing::CheckedAcquisition& acquisition,
                           const geometry::TriangleMesh& surface, const FitCall& call,
                           FitRecord& record) {
  std::optional<Progress> bar;  // its scope ends before anything is printed
  haptics::BuildStage shown{};
  const auto show = [&](haptics::BuildStage stage, int done, int total) {
    if (!bar || stage != shown)
      bar.emplace(stage == haptics::BuildStage::friction ? "finding friction" : "fitting");
    shown = stage;
    bar->show(done, total);
  };
  // Friction needs a noise above zero, so zero is replaced by its default.
  haptics::FrictionOptions friction;
  if (call.fit.noise.force > 0) friction.force_noise = call.fit.noise.force;
  friction.steady_error = kSteadyErrorPerNoise * friction.force_noise;
  try {
    return haptics::build_model(
        acquisition, surface,
        {.fit = call.fit,
         .friction = friction,
         .max_distance = call.max_distance,
         .max_left_out = call.max_left_out,
         .blend_rule = call.blend_rule,
         .triangulation = call.triangulation,
         .dense_samples = call.shared_local ? std::optional(call.dense_samples) : std::nullopt,
         .estimate_offsets = call.estimate_offsets,
         .estimate_force_noise = !call.force_noise,
         .rate = call.rate,
         .progress = show,
         .known_fit = [&](long long contact) { return record.find(contact); },
         .keep_fit = [&](long long contact,
                         const haptics::FitResult& result) { record.add(contact, result); }});
  } catch (const InvalidInput& error) {
    throw InvalidInput(
        with_option_names(error.what(), {{"build_model(): ", call.acquisition.string() + ": "},
                                         {"BuildOptions::rate: ", "--rate: "},
                                         {"BuildOptions::fit.max_bases,", "--max-bases,"},
                                         {"BuildOptions::max_distance", "--max-distance"},
                                         {"BuildOptions::max_left_out = ", "--leave-out "}}));
  }
}

/// A run that fails because of its fits keeps none: another one would find the same.
haptics::BuildResult build_or_forget(const probing::CheckedAcquisition& acquisition,
                                     const geometry::TriangleMesh& surface, const FitCall& call,
                                     FitRecord& record) {
  try {
    return build(acquisition, surface, call, record);
  } catch (const SolverError&) {
    record.remove();
    throw;
  }
}

/// The mesh of the call; without one, it is made of the contacts.
geometry::TriangleMesh surface_of(const FitCall& call,
                                  const probing::CheckedAcquisition& acquisition, Json& warnings) {
  if (!call.surface.empty()) return geometry::read_mesh(call.surface, call.meshes);
  try {
    const double radius = acquisition.records().probe_radius.value_or(probing::kUsualTipRadius);
    probing::ContactSurface made =
        probing::contact_surface(acquisition.contacts(), {.tip_radius = radius});
    spdlog::warn(
        "the surface is made of the {} contacts alone: it is taken as flat between them, and as "
        "ending at the outermost.",
        made.kept.size());
    tell_left_out(made, warnings);
    return std::move(made.mesh);
  } catch (const InvalidInput& wrong) {
    throw InvalidInput(with_option_names(
        wrong.what(),
        {{"contact_surface(): ", call.acquisition.string() + ": without a SURFACE: "}}));
  }
}

/// The measurements with the radius of the call, if they do not say it.
probing::CheckedAcquisition with_probe_radius(probing::CheckedAcquisition acquisition,
                                              std::optional<double> radius) {
  const std::optional<double> known = acquisition.records().probe_radius;
  if (!radius || known == radius) return acquisition;
  if (known) {
    throw InvalidInput(
        fmt::format("--probe-radius: is {:g} mm; the measurements say {:g} mm", *radius, *known));
  }
  probing::Acquisition records = acquisition.records();
  records.probe_radius = radius;
  return records;
}

void fit(const Settings& settings, FitCall call) {
  limit_to_budget(call);
  if (call.force_noise) call.fit.noise.force = *call.force_noise;
  const fs::path record_path = record_file(call.output);
  check_outputs({call.acquisition, call.surface}, {call.output, call.pictures, record_path});
  check_output_folder({call.acquisition, call.surface, call.shapes}, call.output);
  check_replaceable(call.output, haptics::model_entries());
  Json warnings = Json::array();
  const probing::CheckedAcquisition acquisition =
      with_probe_radius(read_plausible_acquisition(call.acquisition, warnings), call.probe_radius);
  tell_rates(call.acquisition, warnings);
  const geometry::TriangleMesh surface = surface_of(call, acquisition, warnings);
  FitRecord record(record_path, settings_of(call));
  if (call.resume) record.resume();
  record.begin();
  const std::size_t kept = record.size();
  haptics::BuildResult built = build_or_forget(acquisition, surface, call, record);
  built.model.made["program"] = "palpate " PALPATE_VERSION;
  built.model.made["acquisition"] = call.acquisition.filename().string();
  built.model.made["surface"] =
      call.surface.empty() ? "made of the contacts" : call.surface.filename().string();
  if (built.local_part) built.model.made["local part"] = sharing_in_words(built);
  if (!call.shapes.empty())
    built.model.response = fit_shapes(built, surface, acquisition, call.shapes);
  haptics::write_model(call.output, built.model, call.encoding);
  record.remove();
  tell_build(built);
  tell_gaps(acquisition, warnings);
  tell_doubts(built, warnings);
  if (!call.pictures.empty()) draw(call, built.model, acquisition);

  Json figures = {{"contacts", built.contacts.size()}, {"kept", kept}};
  figures.update(fit_figures(built, settings.json));
  if (const auto& response = built.model.response) {
    figures["shapes"] = {{"count", response->shape_contacts.size()},
                         {"rms", response->rms},
                         {"largest", response->largest}};
  }
  figures["warnings"] = warnings;
  figures["file"] = call.output.string();
  print(settings, figures,
        (settings.json ? std::string() : per_contact_in_words(built)) +
            fmt::format("{}. {}Written to {}", fit_in_words(built),
                        shapes_in_words(built.model.response), call.output.string()));
}

}  // namespace

void add_fit(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<FitCall>();
  CLI::App* command = app.add_subcommand("fit", "Fit a model to measurements and a surface");
  command->add_option("ACQUISITION", call->acquisition, "Measurements (acquisition.db)")
      ->required();
  command->add_option("SURFACE", call->surface,
                      "Undeformed surface (mesh); without it, one is made of the contacts, flat "
                      "between them");
  add_unit_option(*command, call->meshes);
  command->add_option("-o,--output", call->output, "Model folder to write")->required();
  command
      ->add_option("--accuracy", call->fit.accuracy,
                   "Stop fitting a contact at this RMS [N]; 0: as accurate as the noise of the "
                   "measurements allows")
      ->capture_default_str();
  add_choice<haptics::FitMode>(
      *command, "--passive", call->fit.mode,
      {{"convex", haptics::FitMode::convex},
       {"certified", haptics::FitMode::certified},
       {"local", haptics::FitMode::local}},
      "How a field is made passive: convex, everywhere by construction (default); certified, "
      "proven within the reach of the measurements; local, only near zero");
  add_choice<geometry::ContactTriangulationMethod>(
      *command, "--triangulation", call->triangulation,
      {{"delaunay", geometry::ContactTriangulationMethod::delaunay},
       {"voronoi_dual", geometry::ContactTriangulationMethod::voronoi_dual}},
      "How contacts are triangulated: delaunay, the geodesic Delaunay triangulation (default); "
      "voronoi_dual, the dual of the geodesic Voronoi cells, which may leave out contacts on thin "
      "parts and near the border. Use it if delaunay fails");
  command
      ->add_option("--max-distance", call->max_distance,
                   "Reject a contact that is farther from the surface [mm], after all contacts "
                   "were moved onto it by one small rigid motion")
      ->check(within(at_least(0)))
      ->capture_default_str();
  command
      ->add_option("--leave-out", call->max_left_out,
                   fmt::format("Leave out up to this many contacts that are too far from the "
                               "surface, or whose normal points into it, instead of rejecting the "
                               "measurements. Default: one in {}",
                               probing::kContactsPerMisfit))
      ->check(within(at_least(0)));
  command->add_option("--max-bases", call->fit.max_bases, "Largest number of bases of a field");
  command->add_option(
      "--budget", call->budget_us,
      fmt::format(
          "Time to evaluate one force [us]. It limits the number of bases per field, assuming that "
          "each base costs {} us and that three fields are blended. Locating the contact and "
          "blending take about 0.15 us more, and a slipping contact evaluates many forces per "
          "step: "
          "measure a step with palpate play",
          haptics::kEvaluationCost));
  command
      ->add_option(
          "--force-noise", call->force_noise,
          "Standard deviation of each component of the measured forces [N], for fields and "
          "friction. Default: estimated from the measurements: what forces that were repeated "
          "show, "
          "at least 0.4 % of the largest force, and more if that does not explain the errors")
      ->check(within(at_least(0)));
  command
      ->add_option(
          "--probe-radius", call->probe_radius,
          "Radius of the ball that touched the object [mm], if the measurements do not "
          "say it; the errors of friction depend on it, and the model keeps it for palpate play "
          "--tool-radius")
      ->check(within(above(0).finite()));
  add_choice<bool>(
      *command, "--touch-offset", call->estimate_offsets, {{"estimate", true}, {"none", false}},
      "Where all contacts were only pressed: estimate a constant error of the forces and how deep "
      "below the surface the touches were found, and use them if the measurements support them "
      "(default); none, take forces and touches as recorded");
  command->add_flag("--rate", call->rate,
                    "Where all contacts were only pressed, and samples have times: fit how forces "
                    "depend on the rate, as in tissue, whose loading and unloading differ");
  CLI::Option* shared = command->add_flag(
      "--shared-local", call->shared_local,
      "Learn the local deformation around the tool from contacts with many samples, and fit "
      "contacts with few samples as this local part plus a compliance of their own. Used only if a "
      "test shows a gain (thesis 6.2.1.2); the result is reported");
  command
      ->add_option("--dense-samples", call->dense_samples,
                   "Smallest number of pairs of displacement and force for a contact to count as "
                   "having many samples")
      ->needs(shared)
      ->check(within(at_least(haptics::kFewestDenseSamples)))
      ->capture_default_str();
  command->add_flag_callback(
      "--cbor", [call] { call->encoding = haptics::ModelEncoding::cbor; },
      fmt::format("Write the document in CBOR, field.cbor; this is the default above {} contacts",
                  haptics::kMaxJsonContacts));
  add_choice<std::optional<haptics::BlendRule>>(
      *command, "--blend", call->blend_rule,
      {{"compliances", haptics::BlendRule::compliances},
       {"forces", haptics::BlendRule::forces},
       {"auto", std::nullopt}},
      "What contacts give to places between them: compliances, their forces at displacements that "
      "match the compliance of the place; forces, their forces at the same displacement (thesis "
      "5.3.2); auto, what predicts contacts better from those around them (default)");
  command
      ->add_option("--shapes", call->shapes,
                   "Folder of meshes that 'palpate track --reference SURFACE' made of the range "
                   "maps that the samples name: the model then shows how the whole surface follows "
                   "the tool")
      ->needs("SURFACE");
  command->add_option("--pictures", call->pictures,
                      "Folder for pictures: the contacts, and the contact with the worst fit");
  command->add_flag("--resume", call->resume,
                    "Keep the fits that an earlier run with the same measurements, surface and "
                    "settings finished");
  command->footer(
      "Finished fits are kept in a file beside the model (model.fits for -o model/) until the "
      "model "
      "is written, also after Ctrl-C. With --resume the result is the same as without an "
      "interruption.\nExample:\n  palpate fit acquisition.db surface.ply -o model/");
  command->callback([call, &settings] { fit(settings, *call); });
}

}  // namespace palpate::apps
