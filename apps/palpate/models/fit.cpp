// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "models/fit_record.h"
#include "models/fit_report.h"
#include "models/fit_warnings.h"
#include "palpate/core/error.h"
#include "palpate/core/file_fingerprint.h"
#include "palpate/geometry/edge_splitting.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/haptics/build_model.h"
#include "palpate/haptics/fit_surface_response.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/acquisition.h"
#include "shared/aliases.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/inputs.h"
#include "shared/model_pictures.h"
#include "shared/output_checks.h"
#include "shared/plausible.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

// Each shape is read for the fit and for its error.
constexpr std::size_t kReadings = 2;

struct ShapeFile {
  fs::path mesh;
  std::size_t contact;
  Eigen::Vector3d displacement;
};

std::vector<ShapeFile> shape_files(const haptics::Model& model,
                                   const probing::CheckedAcquisition& acquisition,
                                   const fs::path& meshes) {
  std::map<long long, std::size_t> index;
  for (std::size_t i = 0; i < model.contacts.size(); ++i) index[model.contacts[i].id] = i;
  std::vector<ShapeFile> files;
  std::size_t named = 0;
  fs::path missing;
  for (const probing::Sample& sample : acquisition.samples()) {
    const auto contact = index.find(sample.contact);
    if (sample.slipped || !sample.range_map || contact == index.end()) continue;
    ++named;
    const fs::path mesh = meshes / fs::path(*sample.range_map).filename().replace_extension(".ply");
    std::error_code error;
    if (!fs::exists(mesh, error)) {
      missing = mesh;
      continue;
    }
    const Eigen::Vector3d& from =
        acquisition.contacts()[*acquisition.find(sample.contact)].position;
    files.push_back(
        {mesh, contact->second, model.T_surface_acquisition.linear() * (sample.b - from)});
  }
  if (named == 0) {
    throw InvalidInput(
        "--shapes: no sample that held names a range map (range_map of the samples); each must say "
        "which one was recorded while the tool held it");
  }
  if (files.empty()) {
    throw InvalidInput(fmt::format(
        "--shapes: {} samples name a range map, and none has a mesh: there is no {}; expected the "
        "folder that 'palpate track --reference SURFACE' wrote",
        named, missing.string()));
  }
  return files;
}

haptics::RecordedShape read_shape(const ShapeFile& file, const geometry::TriangleMesh& surface,
                                  const Eigen::Matrix2Xi& ends) {
  const geometry::TriangleMesh mesh = geometry::read_mesh(file.mesh);
  if (mesh.vertices.cols() != surface.vertices.cols() || mesh.triangles != surface.triangles) {
    throw FileError(fmt::format(
        "{}: has other triangles than SURFACE ({} vertices, {} there); track the range maps with "
        "--reference SURFACE",
        file.mesh.string(), mesh.vertices.cols(), surface.vertices.cols()));
  }
  return {file.contact, file.displacement, geometry::with_middles(mesh.vertices, ends)};
}

/// Learns how the surface of a model follows the tool (`haptics::fit_surface_response`), from the
/// meshes of a folder that `palpate track --reference SURFACE` wrote: that of a sample has the name
/// of its range map, and the triangles of the surface. Samples that slipped, and those without a
/// mesh, are left out.
/// \param surface that the model was built with
haptics::SurfaceResponse fit_shapes(const haptics::BuildResult& built,
                                    const geometry::TriangleMesh& surface,
                                    const probing::CheckedAcquisition& acquisition,
                                    const fs::path& meshes) {
  const std::vector<ShapeFile> files = shape_files(built.model, acquisition, meshes);
  Progress bar("reading shapes");
  std::size_t read = 0;
  return haptics::fit_surface_response(built.model, files.size(), [&](std::size_t k) {
    haptics::RecordedShape shape = read_shape(files[k], surface, built.surface_ends);
    bar.show(++read, kReadings * files.size());
    return shape;
  });
}

std::string shapes_in_words(const std::optional<haptics::SurfaceResponse>& response) {
  if (!response) return {};
  return fmt::format(
      "The surface follows the tool as in {} recorded shapes, {:.2f} mm RMS from them, {:.1f} mm "
      "at most. ",
      response->shape_contacts.size(), response->rms, response->largest);
}

struct FitCall {
  fs::path acquisition, surface, output, pictures, shapes;
  haptics::BuildOptions options;
  std::optional<haptics::ModelEncoding> encoding;
  geometry::ReadOptions meshes;
  std::optional<double> probe_radius;  ///< [mm]
  bool resume = false;
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
Json settings_of(FitCall call) {
  Json settings = {
      {"ACQUISITION", file_fingerprint(call.acquisition)},
      {"SURFACE", call.surface.empty() ? std::string() : file_fingerprint(call.surface)},
      {"--unit", call.meshes.unit ? Json(*call.meshes.unit) : Json()},
      {"version of palpate", PALPATE_VERSION}};
  settings.update(option_values(fields_of(call.options)));
  return settings;
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
  haptics::BuildOptions options = call.options;
  options.progress = show;
  options.known_fit = [&](long long contact) { return record.find(contact); };
  options.keep_fit = [&](long long contact, const haptics::FitResult& result) {
    record.add(contact, result);
  };
  return with_names({{"build_model()", call.acquisition.string()}},
                    [&] { return haptics::build_model(acquisition, surface, options); });
}

/// Builds the model. If the fits fail, removes their record: another run would fail as well.
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

/// Returns the mesh of the call; without one, a mesh of the contacts.
geometry::TriangleMesh surface_of(const FitCall& call,
                                  const probing::CheckedAcquisition& acquisition, Json& warnings) {
  if (!call.surface.empty()) return geometry::read_mesh(call.surface, call.meshes);
  geometry::TriangleMesh made =
      surface_of_contacts(acquisition, call.acquisition.string() + ": without a SURFACE", warnings);
  spdlog::warn(
      "the surface is made of the {} contacts alone: it is taken as flat between them, and as "
      "ending at the outermost.",
      made.vertices.cols());
  return made;
}

/// Returns the measurements with the radius of the call, if they do not state one.
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
  const fs::path record_path = record_file(call.output);
  check_outputs({call.acquisition, call.surface}, {call.output, call.pictures, record_path});
  check_model_output({call.acquisition, call.surface, call.shapes}, call.output);
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
  add_required(*command, "ACQUISITION", call->acquisition, "Measurements (acquisition.db)");
  command->add_option("SURFACE", call->surface,
                      "Undeformed surface (mesh); without it, one is made of the contacts, flat "
                      "between them");
  add_unit_option(*command, call->meshes);
  add_required(*command, "-o,--output", call->output, "Model folder to write");
  add_fields(*command, fields_of(call->options));
  add_number(*command, "--probe-radius", call->probe_radius, above(0).finite(),
             "Radius of the ball that touched the object [mm], if the measurements do not "
             "say it; the errors of friction depend on it, and the model keeps it for palpate play "
             "--tool-radius");
  command->add_flag_callback(
      "--cbor", [call] { call->encoding = haptics::ModelEncoding::cbor; },
      fmt::format("Write the document in CBOR, field.cbor; this is the default above {} contacts",
                  haptics::kMaxJsonContacts));
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
      "model is written, also after Ctrl-C. With --resume the result is the same as without an "
      "interruption.\nExample:\n  palpate fit acquisition.db surface.ply -o model/");
  command->callback([call, &settings] { fit(settings, *call); });
}

}  // namespace palpate::apps
