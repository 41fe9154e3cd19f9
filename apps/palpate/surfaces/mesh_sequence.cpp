// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/mesh_sequence.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/file_fingerprint.h"
#include "palpate/core/file_names.h"
#include "palpate/core/work_in_order.h"
#include "shards/shard_run.h"
#include "shared/field_options.h"
#include "shared/map_camera.h"
#include "shared/output_checks.h"
#include "shared/progress.h"
#include "shared/result_folder.h"
#include "shared/surface_colors.h"

namespace palpate::apps {
namespace {

/// A range map of a sequence, to be meshed.
struct SequenceItem {
  std::size_t number = 0;  ///< in the sequence, from 0
  fs::path input, output;
  Json figures = {};
  std::string error = {};                            ///< empty if it worked
  std::vector<ShardFile> inputs = {}, outputs = {};  ///< with --shard
};

/// The results of the range maps, in their order.
struct SequenceReport {
  Json per_mesh = Json::array();
  std::size_t broken = 0;
  std::string first_error = {}, prose = {};
};

/// \param file the mesh, with the name that the user sees.
void add_to(SequenceReport& report, const std::string& range_map, const fs::path& file,
            const Json& figures, const std::string& error) {
  Json entry = {{"range_map", range_map}};
  if (error.empty()) {
    entry["file"] = file.string();
    entry.update(figures);
    report.prose += fmt::format("{} -> {}: {} triangles\n", range_map, file.string(),
                                figures.at("triangles").get<long>());
  } else {
    entry["error"] = error;
    spdlog::error("{}", error);
    if (report.broken++ == 0) report.first_error = error;
  }
  report.per_mesh.push_back(std::move(entry));
}

/// \param kind what was meshed: "range maps".
/// \throws Error if some could not be meshed.
void print_report(const Settings& settings, const SequenceReport& report, const std::string& kind,
                  const fs::path& output) {
  const std::size_t maps = report.per_mesh.size();
  print(settings,
        {{"range_maps", maps}, {"meshes", maps - report.broken}, {"per_mesh", report.per_mesh}},
        report.prose + fmt::format("{} of {} {} were meshed, in {}", maps - report.broken, maps,
                                   kind, output.string()));
  if (report.broken > 0) {
    throw Error(fmt::format("{} of {} {} could not be meshed; the others were.", report.broken,
                            maps, kind));
  }
}

/// \throws FileError if no range map could be meshed.
void refuse_if_all_are_broken(const SequenceReport& report) {
  if (report.broken > 0 && report.broken == report.per_mesh.size())
    throw FileError(report.first_error);
}

/// Rejects range maps whose meshes would have the same name.
void check_mesh_names(const std::vector<fs::path>& maps) {
  std::set<std::string> names;
  for (const fs::path& map : maps) {
    if (names.insert(map.stem().string()).second) continue;
    throw InvalidInput(map.string() + ": another range map is also called " + map.stem().string() +
                       ", and so would its mesh be. Rename one of them, or mesh them into two "
                       "folders.");
  }
}

/// The name of the mesh of a range map.
fs::path mesh_name(const std::string& format, const fs::path& range_map) {
  return range_map.stem().string() + "." + format;
}

std::vector<fs::path> meshes_in(const fs::path& folder, const std::string& format) {
  std::vector<fs::path> meshes;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == "." + format && !is_hidden(entry.path()))
      meshes.push_back(entry.path().filename());
  }
  return meshes;
}

/// Lists the meshes of the range maps that are there from an earlier run, and its shards.
/// \throws InvalidInput if the folder holds meshes of another sequence.
std::vector<fs::path> earlier_results(const MeshCall& call, const std::vector<fs::path>& maps,
                                      const fs::path& folder) {
  std::set<std::string> ours;
  for (const fs::path& map : maps) ours.insert(map.stem().string());
  std::vector<fs::path> results = meshes_in(folder, call.format);
  for (const fs::path& mesh : results) {
    if (ours.contains(mesh.stem().string())) continue;
    throw InvalidInput((folder / mesh).string() +
                       ": is a mesh of no range map of this sequence, so two sequences would be "
                       "mixed. Pass a new or an empty folder, or remove this file.");
  }
  const std::vector<fs::path> shards = shard_files(folder);
  results.insert(results.end(), shards.begin(), shards.end());
  return results;
}

/// The picture of a range map, if it is requested and exists.
fs::path picture_for(const MeshCall& call, const fs::path& range_map) {
  try {
    if (call.steps.color) return color_beside(range_map);
    if (!call.steps.color_images.empty())
      return picture_of(call.steps.color_images, range_map, call.steps.camera);
  } catch (const FileError&) {
    // The mesh reports that it is missing.
  }
  return {};
}

/// The files from which a mesh is made.
std::vector<ShardFile> inputs_of(const MeshCall& call, const fs::path& range_map) {
  std::vector<fs::path> files = {range_map, picture_for(call, range_map)};
  if (call.steps.smooth_depths && !call.steps.noise) files.push_back(noise_beside(range_map));
  if (!call.steps.camera.mask.empty())
    files.push_back(mask_file(range_map, call.steps.camera.mask));
  std::vector<ShardFile> inputs;
  for (const fs::path& file : files)
    if (is_there(file)) inputs.push_back(measured(file));
  return inputs;
}

void make_one(const MeshCall& call, SequenceItem& item) {
  try {
    MadeMesh made = make_mesh(item.input, call.steps);
    write_made(made, item.input, item.output);
    item.figures = std::move(made.figures);
    if (call.shard) item.outputs = {measured(item.output, call.output)};
  } catch (const OutputError&) {
    throw;  // if there is no space for this file, there is none for the others
  } catch (const InvalidInput& error) {
    item.error = with_names(error, {});
  } catch (const Error& error) {
    item.error = error.what();
  }
  if (call.shard) item.inputs = inputs_of(call, item.input);
}

/// Meshes a block of the range maps, and passes them to `deliver` in order.
void make_all(const MeshCall& call, const std::vector<fs::path>& maps, const ShardBlock& block,
              const fs::path& place, const std::function<void(SequenceItem&)>& deliver) {
  std::size_t begun = block.first;
  const auto next = [&]() -> std::optional<SequenceItem> {
    if (begun == block.end) return std::nullopt;
    const fs::path& map = maps[begun];
    return SequenceItem{
        .number = begun++, .input = map, .output = place / mesh_name(call.format, map)};
  };
  work_in_order<SequenceItem>(
      next, [&](SequenceItem& item) { make_one(call, item); }, deliver, usual_live_items());
}

/// Meshes all range maps.
SequenceReport mesh_all(const MeshCall& call, const std::vector<fs::path>& maps) {
  ResultFolder folder(
      call.output, [&](const fs::path& output) { return earlier_results(call, maps, output); },
      ResultFolder::Unfinished::dropped);
  folder.begin();
  SequenceReport report;
  Progress progress("meshing");
  const auto kept = [&] {
    return folder.what_is_kept(report.per_mesh.size() - report.broken, maps.size());
  };
  const InterruptMessage message(kept());
  make_all(call, maps, {0, maps.size()}, folder.place(), [&](SequenceItem& item) {
    add_to(report, item.input.filename().string(), call.output / item.output.filename(),
           item.figures, item.error);
    InterruptMessage::set_kept(kept());
    progress.show(report.per_mesh.size(), maps.size());
  });
  refuse_if_all_are_broken(report);
  folder.finish([](const fs::path&) { return true; });
  return report;
}

/// Fingerprints of the cameras: meshes depend on them, and they are often in files beside maps.
std::string camera_print(const MeshCall& call, const std::vector<fs::path>& maps) {
  std::set<fs::path> folders;
  for (const fs::path& map : maps) folders.insert(map.parent_path());
  std::string prints;
  for (const fs::path& folder : folders) {
    const fs::path rig = folder / "rig.yaml";
    if (call.steps.camera.rig.empty() && is_there(rig)) prints += file_fingerprint(rig);
  }
  return prints;
}

void mesh_shard(const Settings& settings, const CLI::App& command, const MeshCall& call,
                const std::vector<fs::path>& maps, const std::string& kind) {
  ShardCall shared = shard_call(command, call.output, *call.shard, maps);
  shared.settings["rig.yaml"] = camera_print(call, maps);
  if (const auto& noise = call.steps.noise)
    shared.settings["depth noise"] = {noise->constant, noise->quadratic};
  shared.record = {{"kind", kind}, {"format", call.format}};
  ShardRun run(
      shared, *call.shard, [&](const fs::path& folder) { return meshes_in(folder, call.format); },
      [] {});
  if (run.is_finished()) return run.report(settings, "range map");
  const ShardBlock block = block_of(*call.shard, maps.size());
  Progress progress("meshing");
  const InterruptMessage message("shard " + to_string(*call.shard) + " is not finished");
  make_all(call, maps, block, call.output, [&](SequenceItem& item) {
    progress.show(item.number - block.first + 1, block.end - block.first);
    if (!item.error.empty()) spdlog::error("{}", item.error);
    run.add({.number = item.number,
             .name = item.input.filename().string(),
             .error = std::move(item.error),
             .inputs = std::move(item.inputs),
             .outputs = std::move(item.outputs),
             .result = std::move(item.figures)});
  });
  run.finish();
  run.report(settings, "range map");
}

}  // namespace

void mesh_sequence(const Settings& settings, const CLI::App& command, const MeshCall& call) {
  if (!call.picture.empty())
    throw InvalidInput("--picture: works for one mesh, not for a sequence of range maps.");
  check_color(call.steps, "." + call.format);
  check_outputs(call.inputs, {call.output});
  const MapCamera& camera = call.steps.camera;
  const std::vector<fs::path> maps = list_range_maps(call.inputs, camera);
  check_camera_options(maps.front(), camera);
  // One message about a camera that serves all.
  if (!camera.rig.empty()) (void)camera.files->cameras.read(camera.rig);
  check_mesh_names(maps);
  const char* const kind = is_range_map(maps.front()) ? "range maps" : "depth images";
  if (call.shard) return mesh_shard(settings, command, call, maps, kind);
  print_report(settings, mesh_all(call, maps), kind, call.output);
}

void merge_mesh_shards(const Settings& settings, const ShardCall& call,
                       const ShardMergeOptions& options) {
  SequenceReport report;
  const std::string format = call.record.at("format");
  read_shards(call, options, [&](const ShardItem& item) {
    add_to(report, item.name, call.output / mesh_name(format, item.name), item.result, item.error);
  });
  refuse_if_all_are_broken(report);
  print_report(settings, report, call.record.at("kind"), call.output);
}

}  // namespace palpate::apps
