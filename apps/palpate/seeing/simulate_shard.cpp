// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/simulate_shard.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "palpate/core/file_fingerprint.h"
#include "shards/shard_run.h"
#include "shared/inputs.h"
#include "shared/interrupts.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

/// The name of a frame: its mesh and its distance, which distinguish it from others.
fs::path shot_name(const SimulateCall& call, const Shot& shot) {
  const std::string mesh = call.scene.meshes[shot.mesh].filename().string();
  return shot.distance ? fs::path(fmt::format("{} at {} mm", mesh, *shot.distance))
                       : fs::path(mesh);
}

/// The meshes from which a frame is made: its own, the first one, which gives the pose of all, and
/// the next one, towards which the shutter blurs.
std::vector<ShardFile> meshes_of(const SimulateCall& call, const Shot& shot) {
  std::vector<ShardFile> files = {measured(call.scene.meshes[shot.mesh])};
  if (shot.mesh > 0) files.push_back(measured(call.scene.meshes.front()));
  if (call.scene.shutter > 0 && shot.mesh + 1 < call.scene.meshes.size())
    files.push_back(measured(call.scene.meshes[shot.mesh + 1]));
  return files;
}

ShardItem simulate_item(const SimulateCall& call, const SimulateSetup& setup, std::size_t number) {
  const Shot& shot = setup.shots[number];
  ShardItem item{.number = number,
                 .name = shot_name(call, shot).string(),
                 .error = {},
                 .inputs = meshes_of(call, shot),
                 .outputs = {},
                 .result = nullptr};
  for (const fs::path& file : do_shot(call, setup, call.output, number).files)
    item.outputs.push_back(measured(file, call.output));
  return item;
}

}  // namespace

void simulate_shard(const Settings& settings, const CLI::App& command, const SimulateCall& call,
                    const SimulateSetup& setup) {
  std::vector<fs::path> names;
  for (const Shot& shot : setup.shots) names.push_back(shot_name(call, shot));
  ShardCall shared = shard_call(command, call.output, *call.shard, names);
  for (const fs::path& image : panel_files(call, setup.pattern))
    shared.settings[image.filename().string()] = file_fingerprint(image);
  shared.record = {{"images", setup.panels.size()}};
  const auto earlier = [](const fs::path& folder) {
    return is_there(folder / "frames") ? std::vector<fs::path>{"frames"} : std::vector<fs::path>{};
  };
  ShardRun run(shared, *call.shard, earlier, [&] { write_setup(setup, call.output); });
  if (run.is_finished()) return run.report(settings, "frame");
  const ShardBlock block = block_of(*call.shard, setup.shots.size());
  Progress progress("simulating");
  const InterruptMessage message("shard " + to_string(*call.shard) + " is not finished");
  for (std::size_t number = block.first; number < block.end; ++number) {
    run.add(simulate_item(call, setup, number));
    progress.show(number - block.first + 1, block.end - block.first);
  }
  run.finish();
  run.report(settings, "frame");
}

void merge_simulate_shards(const Settings& settings, const ShardCall& call,
                           const ShardMergeOptions& options) {
  std::size_t shots = 0;
  read_shards(call, options, [&](const ShardItem&) { ++shots; });
  print_simulated(settings, {}, shots, call.record.at("images"), call.output);
}

}  // namespace palpate::apps
