// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <memory>
#include <optional>

#include "palpate/core/error.h"
#include "seeing/decode_shard.h"
#include "seeing/simulate_shard.h"
#include "shards/shard_merge.h"
#include "shared/command_line.h"
#include "shared/inputs.h"
#include "shared/result_folder.h"
#include "surfaces/mesh_sequence.h"

namespace palpate::apps {
namespace {

struct MergeShardsCall {
  fs::path folder;
  ShardMergeOptions options;
};

ShardCall call_in(const fs::path& folder) {
  (void)is_folder(folder);
  std::optional<ShardCall> call = read_call(folder);
  if (call) return std::move(*call);
  throw InvalidInput(folder.string() +
                     ": holds no shards; give the folder into which a command with --shard, such "
                     "as palpate decode --shard 1/7, has written.");
}

void merge_shards(const Settings& settings, const MergeShardsCall& merge) {
  const ShardCall call = call_in(merge.folder);
  // Shards may run meanwhile, other runs may not, and two merges run one after the other.
  const FolderLock folder(merge.folder, FolderLock::With::others);
  const FolderLock journals(call_file(merge.folder).parent_path());
  if (call.command == "decode") return merge_decode_shards(settings, call, merge.options);
  if (call.command == "mesh") return merge_mesh_shards(settings, call, merge.options);
  if (call.command == "simulate") return merge_simulate_shards(settings, call, merge.options);
  throw FileError(fmt::format("{}: names the command {}, whose shards this version cannot merge.",
                              call_file(merge.folder).string(), call.command));
}

}  // namespace

void add_merge_shards(CLI::App& app, const Settings& settings) {
  auto call = std::make_shared<MergeShardsCall>();
  CLI::App* command = app.add_subcommand(
      "merge-shards", "Check and join the parts that a command with --shard has made");
  add_required(*command, "FOLDER", call->folder, "Folder into which the shards were written");
  command->add_flag("--allow-missing", call->options.allow_missing,
                    "Report on the shards that are finished, as a preview; nothing is written");
  command->add_flag("--verify", call->options.verify,
                    "Also read all items and results, and compare their content with the journals");
  command->add_flag("--force", call->options.force,
                    "Accept range maps of frames that do not fit rig, pattern or colours");
  command->footer(
      "Checks that all shards are there, that they are of one call, one version and the same "
      "items, and that their results are as they were written. A missing shard is named, with the "
      "command that makes it; the exit status is then 1. Then writes and prints what the command "
      "without --shard would have: results are the same to the byte.\n"
      "Examples:\n  palpate decode frames/ --rig rig.yaml --pattern pattern.yaml --colors "
      "colors.yaml -o range/ --shard 1/2\n"
      "  palpate merge-shards range/");
  command->callback([call, &settings] { merge_shards(settings, *call); });
}

}  // namespace palpate::apps
