// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string_view>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/error_statistics.h"
#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/surface_map.h"
#include "palpate/haptics/model_io.h"
#include "palpate/haptics/scale_model.h"
#include "palpate/haptics/transfer_model.h"
#include "palpate/pictures/draw_distances.h"
#include "palpate/probing/csv.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/model_pictures.h"
#include "shared/output_checks.h"
#include "shared/words.h"

namespace palpate::apps {
namespace {

/// Smallest range of the colours of a map's distortion.
constexpr double kLeastDoublings = 0.01;

struct TransferCall {
  fs::path model, output, picture, onto, landmarks, distortion, distortion_mesh;
  std::optional<double> scale;
  std::vector<double> axis;
  std::optional<haptics::ForceScaling> forces;
  geometry::ReadOptions meshes;
  geometry::SurfaceMapOptions map;
};

void scale(const Settings& settings, const TransferCall& call) {
  haptics::ScaleModelOptions options{.factor = *call.scale};
  if (call.forces) options.forces = *call.forces;
  if (!call.axis.empty()) options.axis = Eigen::Vector3d(call.axis.data());
  const haptics::ScaledModel scaled =
      haptics::scale_model(haptics::read_model(call.model), options);
  haptics::write_model(call.output, scaled.model);
  if (!call.picture.empty()) {
    draw_model_contacts(call.picture, scaled.model,
                        fmt::format("{} scaled by {}", call.model.string(), options.factor));
  }
  const std::string refitted =
      scaled.refitted == 0
          ? "every field exactly"
          : fmt::format("{} fields were refitted, with errors of at most {} (RMS at most {})",
                        scaled.refitted, newtons(scaled.refit_largest), newtons(scaled.refit_rms));
  print(settings,
        {{"contacts", scaled.model.contacts.size()},
         {"scale", options.factor},
         {"forces", haptics::to_string(options.forces)},
         {"refitted", scaled.refitted},
         {"refit_rms", scaled.refit_rms},
         {"refit_largest", scaled.refit_largest},
         {"file", call.output.string()}},
        fmt::format("{} contacts were scaled, {}. Written to {}", scaled.model.contacts.size(),
                    refitted, call.output.string()));
}

/// Columns sx,sy,sz (on the model's surface) and tx,ty,tz (on the target), one pair per line.
geometry::Landmarks read_landmarks(const fs::path& path) {
  constexpr std::array<std::string_view, 6> kColumns = {"sx", "sy", "sz", "tx", "ty", "tz"};
  probing::CsvReader row(path, kColumns);
  std::vector<double> source, target;
  while (row.next()) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      source.push_back(row.number(axis));
      target.push_back(row.number(axis + 3));
    }
  }
  const auto count = static_cast<Eigen::Index>(source.size() / 3);
  return {.source = Eigen::Matrix3Xd::Map(source.data(), 3, count),
          .target = Eigen::Matrix3Xd::Map(target.data(), 3, count)};
}

/// Writes the distortion of the map on the target, as a picture and as a mesh with attributes.
void write_distortion(const TransferCall& call, const geometry::TriangleMesh& source,
                      const geometry::SurfaceMap& map) {
  const geometry::TriangleMesh image{.vertices = map.positions, .triangles = source.triangles};
  if (!call.distortion.empty()) {
    Eigen::VectorXd doublings = map.area_distortion.array().log() / std::log(2.0);
    for (Eigen::Index t = 0; t < doublings.size(); ++t)
      if (map.folded[t]) doublings[t] = std::nan("");
    if (!doublings.array().isFinite().any()) doublings.setZero();  // everything is folded
    const geometry::ErrorStatistics spread =
        geometry::error_statistics({doublings.begin(), doublings.end()});
    pictures::draw_distances(
        call.distortion, image, doublings,
        {.title = "Map of the surface: " + std::string(to_string(map.verdict)),
         .subtitle = fmt::format("{:.2g} % of the area is distorted or folded; the image covers "
                                 "{:.1f} % of the target",
                                 100 * map.distorted_share, 100 * map.coverage),
         .limit = std::max(spread.p95, kLeastDoublings),
         .scale = "log2 of the area of the map over that of the model"});
  }
  if (call.distortion_mesh.empty()) return;
  geometry::MeshFile file;
  file.mesh = image;
  const auto add = [&](const char* name, const Eigen::VectorXd& values) {
    geometry::set_attribute(file.vertex_attributes,
                            {.name = name,
                             .values = std::vector<double>(values.begin(), values.end()),
                             .list_sizes = {}});
  };
  add("area_distortion", geometry::vertex_means(source, map.area_distortion));
  add("angle_distortion", geometry::vertex_means(source, map.angle_distortion));
  add("singular_value_1", geometry::vertex_means(source, map.singular_values.row(0)));
  add("singular_value_2", geometry::vertex_means(source, map.singular_values.row(1)));
  add("distorted", geometry::vertex_means(source, map.distorted.cast<double>()));
  geometry::write_mesh_file(call.distortion_mesh, file);
}

void map_onto(const Settings& settings, const TransferCall& call) {
  const haptics::Model model = haptics::read_model(call.model);
  const geometry::TriangleMesh target = geometry::read_mesh(call.onto, call.meshes);
  const geometry::SurfaceMap map =
      geometry::map_surface(model.surface, target, read_landmarks(call.landmarks), call.map);
  write_distortion(call, model.surface, map);
  if (map.verdict == geometry::SurfaceMapVerdict::not_sensible) {
    throw SolverError(
        fmt::format("{} has no sensible map onto {}: {}. Check that the landmarks correspond, add "
                    "landmarks where the map is distorted (--distortion draws it), or increase "
                    "--max-bad-share.",
                    call.model.string(), call.onto.string(), map.reason));
  }
  if (map.verdict == geometry::SurfaceMapVerdict::distorted)
    spdlog::warn("the map is distorted: {}", map.reason);
  haptics::TransferModelOptions options;
  if (call.forces) options.forces = *call.forces;
  haptics::TransferredModel transferred = haptics::transfer_model(model, target, map, options);
  transferred.model.made["transferred onto"] = call.onto.filename().string();
  haptics::write_model(call.output, transferred.model);
  if (!call.picture.empty())
    draw_model_contacts(call.picture, transferred.model,
                        fmt::format("{} on {}", call.model.string(), call.onto.string()));
  for (const long long id : transferred.distorted)
    spdlog::warn("contact {} is where the map is distorted; it may feel wrong.", id);
  for (const long long id : transferred.isolated)
    spdlog::warn("contact {} is in no triangle of contacts: there are too few around it.", id);
  print(settings,
        {{"contacts", transferred.model.contacts.size()},
         {"verdict", geometry::to_string(map.verdict)},
         {"scale", map.scale},
         {"forces", haptics::to_string(options.forces)},
         {"distorted_share", map.distorted_share},
         {"folded_share", map.folded_share},
         {"coverage", map.coverage},
         {"landmark_rms", map.landmark_rms},
         {"distorted_contacts", transferred.distorted},
         {"file", call.output.string()}},
        fmt::format(
            "{} contacts were transferred to {}, which is {:.3f} times as large: {}. Written to {}",
            transferred.model.contacts.size(), call.onto.string(), map.scale, map.reason,
            call.output.string()));
}

void transfer(const Settings& settings, const TransferCall& call) {
  const std::vector<fs::path> inputs = {call.model, call.onto, call.landmarks};
  check_outputs(inputs, {call.output, call.picture, call.distortion, call.distortion_mesh});
  check_model_output(inputs, call.output);
  if (call.scale) {
    scale(settings, call);
  } else if (!call.onto.empty()) {
    map_onto(settings, call);
  } else {
    throw InvalidInput(
        "palpate transfer: nothing to do. Pass --scale, or --onto with --landmarks.");
  }
}

void add_map_options(CLI::App& command, const std::shared_ptr<TransferCall>& call,
                     CLI::Option* scale) {
  CLI::Option* onto = command
                          .add_option("--onto", call->onto,
                                      "Mesh of the same topology to which the model is transferred")
                          ->excludes(scale);
  CLI::Option* landmarks = command.add_option(
      "--landmarks", call->landmarks,
      "With --onto: CSV of at least three pairs of points, sx,sy,sz on the model's surface and "
      "tx,ty,tz on the other [mm]");
  onto->needs(landmarks);
  landmarks->needs(onto);
  add_unit_option(command, call->meshes);
  command
      .add_option("--distortion", call->distortion,
                  "With --onto: draw how much the map stretches areas (PNG). It is drawn even if "
                  "the map is rejected; folded parts are grey")
      ->needs(onto);
  command
      .add_option("--distortion-mesh", call->distortion_mesh,
                  "With --onto: the model's surface mapped onto the other, with distortions as "
                  "vertex attributes (PLY)")
      ->needs(onto);
  add_fields_of(*onto, command, fields_of(call->map));
}

}  // namespace

void add_transfer(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<TransferCall>();
  CLI::App* command =
      app.add_subcommand("transfer", "Transfer a model to an object of another size or shape");
  add_required(*command, "MODEL", call->model, "Model folder");
  add_required(*command, "-o,--output", call->output, "Model folder to write");
  CLI::Option* by = add_number(*command, "--scale", call->scale, above(0),
                               "Factor for lengths, about the centre");
  command
      ->add_option("--axis", call->axis, "With --scale: only along this direction, such as 1,0,0")
      ->expected(3)
      ->delimiter(',')
      ->needs(by);
  add_map_options(*command, call, by);
  add_choice<haptics::ForceScaling>(
      *command, "--forces", call->forces,
      {{"material", haptics::ForceScaling::material},
       {"forces", haptics::ForceScaling::forces},
       {"feel", haptics::ForceScaling::feel}},
      "How forces scale if lengths scale by s. material: as for the same material, by s^2 at "
      "displacements scaled by s; forces: unchanged at displacements scaled by s; feel: unchanged "
      "at the same displacements [mm] (default: material with --scale, feel with --onto)");
  command->add_option("--picture", call->picture, "Draw the new model's contacts (PNG)");
  command->footer(
      "With --axis, the isotropic bases of the fields are fitted again. The largest error of a "
      "force is reported.\n"
      "Examples:\n  palpate transfer model/ --scale 1.5 -o larger/\n"
      "  palpate transfer model/ --scale 2 --axis 1,0,0 --forces material -o longer/\n"
      "  palpate transfer model/ --onto patient.ply --landmarks pairs.csv -o patient/ --distortion "
      "map.png");
  command->callback([call, &settings] { transfer(settings, *call); });
}

}  // namespace palpate::apps
