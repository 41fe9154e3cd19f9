// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/field_text.h"
#include "palpate/core/file_names.h"
#include "palpate/geometry/cloud_distance.h"
#include "palpate/geometry/cloud_selection.h"
#include "shared/call_checks.h"
#include "shared/command_line.h"
#include "shared/field_options.h"
#include "shared/map_camera.h"
#include "shared/output_checks.h"
#include "shared/surface_colors.h"
#include "surfaces/cloud_steps.h"
#include "surfaces/describe_mesh.h"

namespace palpate::apps {
namespace {

using Value = std::string;
using Run = std::function<void(WorkedCloud&, const Value&, CloudSettings&)>;

struct CloudCall {
  std::vector<fs::path> inputs;
  fs::path output;
  std::string viewpoint;
  bool single_precision = false;
  CloudSettings settings;
  std::map<const CLI::Option*, Run> steps;
  std::vector<CLI::Option*> references;  ///< steps whose values are files
};

double number_of(const Value& value) { return numbers_of(value)->front(); }

/// A step in the order of the command line; any step may be repeated.
CLI::Option* add_step(CLI::App& command, CloudCall& call, const std::string& name,
                      const std::string& type, const std::string& help, Run run) {
  CLI::Option* const option = command.add_option(name, help)
                                  ->type_name(type)
                                  ->expected(1)
                                  ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  call.steps[option] = std::move(run);
  return option;
}

/// A step whose value is a field of a list, which checks it.
template <typename Options>
void add_field_step(CLI::App& command, CloudCall& call, const std::string& name,
                    Options CloudSettings::*options, const char* field, const std::string& help,
                    void (*step)(WorkedCloud&, const CloudSettings&)) {
  add_step(
      command, call, name, "NUMBER", help,
      [options, field, step](WorkedCloud& worked, const Value& value, CloudSettings& settings) {
        assign(fields_of(settings.*options), field, value);
        step(worked, settings);
      })
      ->check(value_of_field(fields_of(call.settings.*options), field));
}

void add_removing_steps(CLI::App& command, CloudCall& call) {
  add_step(command, call, "--crop", "TEXT", "Keep the points in the box X0,Y0,Z0,X1,Y1,Z1 [mm]",
           [](WorkedCloud& worked, const Value& value, const CloudSettings&) {
             const std::vector<double> ends = *numbers_of(value);
             crop(worked, {Eigen::Vector3d(ends[0], ends[1], ends[2]),
                           Eigen::Vector3d(ends[3], ends[4], ends[5])});
           })
      ->check(list_of_numbers(
          [](const std::vector<double>& ends) {
            return ends.size() == 6 && ends[0] <= ends[3] && ends[1] <= ends[4] &&
                   ends[2] <= ends[5];
          },
          "six numbers X0,Y0,Z0,X1,Y1,Z1 with X0 <= X1, Y0 <= Y1 and Z0 <= Z1"));
  add_field_step(command, call, "--outliers", &CloudSettings::outliers, "max_deviations",
                 "Remove points whose mean distance from their nearest ones is more than this many "
                 "standard deviations above the mean; 2 or 3 are usual",
                 &remove_outliers);
  add_step(command, call, "--isolated", "TEXT",
           "MM,COUNT: remove points with fewer than COUNT others within MM [mm]",
           [](WorkedCloud& worked, const Value& value, const CloudSettings&) {
             const std::vector<double> numbers = *numbers_of(value);
             remove_isolated(worked, numbers[0], static_cast<int>(numbers[1]));
           })
      ->check(list_of_numbers(
          [](const std::vector<double>& numbers) {
            return numbers.size() == 2 && numbers[0] > 0 && numbers[1] >= 1 &&
                   numbers[1] <= geometry::kMostNeighbours && numbers[1] == std::floor(numbers[1]);
          },
          "MM,COUNT with MM > 0 and a whole COUNT in [1, 1000]"));
  add_step(command, call, "--voxel", "FLOAT",
           "Average the points in each cube of this edge [mm], with their attributes",
           [](WorkedCloud& worked, const Value& value, const CloudSettings&) {
             average_voxels(worked, number_of(value));
           })
      ->check(within(above(0).finite()));
  add_step(command, call, "--poisson", "FLOAT",
           "Keep points at least this far apart [mm], without larger gaps",
           [](WorkedCloud& worked, const Value& value, const CloudSettings&) {
             sample_poisson(worked, number_of(value));
           })
      ->check(within(above(0).finite()));
}

void add_finding_steps(CLI::App& command, CloudCall& call) {
  const std::string of_shape =
      "Find the % with the most points within this distance of it [mm]; points that belong to a "
      "shape already do not count. The attribute shape gets its number at these points";
  const auto add_shape = [&](const std::string& shape, auto* mark) {
    std::string help = of_shape;
    add_field_step(command, call, "--" + shape, &CloudSettings::shapes, "tolerance",
                   help.replace(help.find('%'), 1, shape), mark);
  };
  add_shape("plane", &mark_plane);
  add_shape("sphere", &mark_sphere);
  add_shape("cylinder", &mark_cylinder);
  add_field_step(command, call, "--cluster", &CloudSettings::clusters, "max_gap",
                 "Divide the points into clusters, between which is more than this gap [mm]; marks "
                 "them in the attribute cluster: 0 is the largest, -1 none",
                 &mark_clusters);
  const auto add_found = [&](const std::string& name, const std::string& help,
                             void (*step)(WorkedCloud&)) {
    CLI::Option* const option = command.add_flag(name)->description(help)->multi_option_policy(
        CLI::MultiOptionPolicy::TakeAll);
    call.steps[option] = [step](WorkedCloud& worked, const Value&, const CloudSettings&) {
      step(worked);
    };
  };
  add_found("--keep", "Keep only the shape, or the largest cluster, just found", &keep_found);
  add_found("--remove", "Remove the shape, or the largest cluster, just found", &remove_found);
}

void add_measuring_steps(CLI::App& command, CloudCall& call) {
  add_field_step(command, call, "--normals", &CloudSettings::normals, "neighbours",
                 "Find normals from this number of neighbours (usually 16); they point to the "
                 "camera of range maps or the --viewpoint, otherwise outwards",
                 &find_normals);
  call.references = {
      add_step(command, call, "--from-mesh", "TEXT",
               "Measure the signed distance of each point from this mesh or range map; attribute "
               "distance [mm]",
               [](WorkedCloud& worked, const Value& value, const CloudSettings& settings) {
                 measure_from_mesh(worked, value, settings);
               }),
      add_step(command, call, "--from-cloud", "TEXT",
               "Measure the distance of each point from the nearest point of this file; attribute "
               "distance [mm]",
               [](WorkedCloud& worked, const Value& value, const CloudSettings& settings) {
                 measure_from_cloud(worked, value, settings);
               })};
}

/// Refuses options of steps that are not done.
void refuse_idle_options(const CLI::App& command) {
  const std::vector<std::string> spheres = {"--sphere", "--cylinder"},
                                 shapes = {"--plane", "--sphere", "--cylinder"};
  const std::vector<std::pair<std::string, std::vector<std::string>>> all = {
      {"--outlier-neighbours", {"--outliers"}},
      {"--viewpoint", {"--normals"}},
      {"--min-share", shapes},
      {"--max-radius", spheres},
      {"--seed", shapes},
      {"--min-points", {"--cluster"}}};
  for (const auto& [name, steps] : all) {
    const auto is_done = [&](const std::string& step) { return command.count(step) > 0; };
    if (command.count(name) == 0 || std::ranges::any_of(steps, is_done)) continue;
    throw InvalidInput(fmt::format("{}: does nothing without {}", name, fmt::join(steps, " or ")));
  }
}

/// Writes the cloud. PLY cannot represent unknown points, and has no grid.
void write_cloud(const CloudCall& call, geometry::PointCloud& cloud) {
  if (lower_extension(call.output) == ".ply") {
    std::vector<int> known;
    for (int i = 0; i < cloud.points.cols(); ++i) {
      if (cloud.points.col(i).allFinite()) known.push_back(i);
    }
    cloud = geometry::selected(cloud, known);
  }
  geometry::write_point_cloud(call.output, cloud, {.single_precision = call.single_precision});
}

/// Returns the camera that saw the points, if the call names it.
std::optional<geometry::Camera> camera_of(const CloudCall& call) {
  const MapCamera& camera = call.settings.camera;
  const fs::path& first = call.inputs.front();
  if (camera.rig.empty() && !is_range_map(first)) return std::nullopt;
  return camera.files->cameras.read(rig_of(first, camera.rig)).camera;
}

void check_call(CloudCall& call) {
  const std::string extension = lower_extension(call.output);
  if (extension != ".pcd" && extension != ".ply" && !is_range_map(call.output))
    throw InvalidInput(call.output.string() +
                       ": points are written as .pcd or .ply, organised ones also as a range map "
                       "(.tiff)");
  if (is_range_map(call.output) && call.single_precision)
    throw InvalidInput(call.output.string() +
                       ": --single works for .pcd and .ply; range maps are always float");
  std::vector<fs::path> inputs = call.inputs;
  for (const CLI::Option* reference : call.references) {
    for (const std::string& file : reference->results()) inputs.emplace_back(file);
  }
  std::vector<fs::path> outputs = {call.output};
  if (is_range_map(call.output)) outputs.push_back(color_beside(call.output));
  if (call.settings.color)
    std::ranges::transform(call.inputs, std::back_inserter(inputs), color_beside);
  check_outputs(inputs, outputs);
  if (call.viewpoint.empty()) return;
  const std::vector<double> place = *numbers_of(call.viewpoint);
  call.settings.viewpoint = Eigen::Vector3d(place[0], place[1], place[2]);
}

void cloud(const CLI::App& command, const Settings& settings, CloudCall& call) {
  refuse_idle_options(command);
  check_call(call);
  WorkedCloud worked = load_cloud(call.inputs, call.settings);
  const Eigen::Index read = known_count(worked.cloud);
  std::map<const CLI::Option*, std::size_t> done;
  for (const CLI::Option* option : command.parse_order()) {
    const auto step = call.steps.find(option);
    if (step == call.steps.end()) continue;
    step->second(worked, option->results().at(done[option]++), call.settings);
  }
  std::string camera;
  if (is_range_map(call.output))
    camera = "; " + write_as_range_map(call.output, worked.cloud, camera_of(call));
  else
    write_cloud(call, worked.cloud);
  const Description description = describe_cloud(worked.cloud);
  Json figures = {{"read", read}, {"steps", worked.steps}};
  figures.update(description.figures);
  figures["file"] = call.output.string();
  print(settings, figures,
        worked.prose + description.prose + ", written to " + call.output.string() + camera);
}

}  // namespace

void add_cloud(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<CloudCall>();
  CLI::App* command = app.add_subcommand(
      "cloud", "Sample, clean, segment and measure point clouds, also of range maps");
  add_required(*command, "POINTS", call->inputs,
               "Point file (.pcd, .ply), range map (TIFF), depth image (16-bit PNG) or mesh file "
               "(its vertices); the points of several files are joined");
  add_required(*command, "-o,--output", call->output,
               "Point file (.pcd or .ply) or range map (.tiff) to write");
  add_camera_options(*command, call->settings.camera);
  add_unit_option(*command, call->settings.points);
  command->add_flag("--color", call->settings.color,
                    "Colour the points as the surface is in the picture that decode "
                    "--surface-color has written beside each range map");
  add_removing_steps(*command, *call);
  add_measuring_steps(*command, *call);
  add_finding_steps(*command, *call);
  command
      ->add_option("--viewpoint", call->viewpoint,
                   "Position X,Y,Z of the sensor [mm]: normals point there")
      ->check(list_of_numbers([](const std::vector<double>& place) { return place.size() == 3; },
                              "three numbers X,Y,Z"));
  constexpr std::array<std::string_view, 5> kOfSteps{"neighbours", "min_share", "max_radius",
                                                     "seed", "min_points"};
  add_fields(*command, fields_of(call->settings.outliers), kOfSteps);
  add_fields(*command, fields_of(call->settings.shapes), kOfSteps);
  add_fields(*command, fields_of(call->settings.clusters), kOfSteps);
  command->add_flag("--single", call->single_precision,
                    "Write float instead of double, as programs built on PCL read");
  command->footer(
      "Steps are done in the order in which they are given: --crop, --outliers, --isolated, "
      "--voxel, --poisson, --normals, --from-mesh, --from-cloud, --plane, --sphere, --cylinder, "
      "--cluster, --keep, --remove. Each may be given several times. A PCD file of one range map "
      "stays organised, with NaN for removed points, unless --voxel or --poisson makes other "
      "points; a range map's deviations (from decode --sigma) become the attribute sigma. With "
      "-o NAME.tiff, an organised cloud becomes a range map. Its camera is that of --camera or of "
      "the rig.yaml in the folder; without these, it is computed from the points.\n\n"
      "Examples:\n  palpate cloud range/000000.tiff -o points.pcd --color --single\n"
      "  palpate cloud scan.ply --outliers 3 --voxel 0.5 --normals 16 -o small.ply\n"
      "  palpate cloud range/000000.tiff --plane 0.5 --remove --cluster 3 --keep -o object.ply\n"
      "  palpate cloud scan.pcd --from-mesh surface.ply -o errors.ply --json\n"
      "  palpate cloud organised.pcd --unit m -o range/000000.tiff");
  command->callback([command, call, &settings] { cloud(*command, settings, *call); });
}

}  // namespace palpate::apps
