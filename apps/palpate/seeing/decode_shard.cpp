// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/decode_shard.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <map>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/rig.h"
#include "seeing/decode_record.h"
#include "seeing/decode_report.h"
#include "shards/shard_run.h"
#include "shared/interrupts.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A video can only be read from its beginning, and its number of frames is a guess.
void refuse_videos(const std::vector<fs::path>& files) {
  const auto video = std::ranges::find_if_not(
      files, [](const fs::path& file) { return sensing::has_frame_name(file); });
  if (video == files.end()) return;
  throw InvalidInput("--shard: " + video->string() +
                     " is no image; parts of a video cannot be decoded on their own. Write its "
                     "frames as PNG first, or leave out --shard.");
}

/// The next frame of a block.
std::optional<sensing::SourceFrame> next_in(const ShardBlock& block, sensing::FrameSource& source) {
  while (auto frame = source.next()) {
    if (frame->number >= block.end) return std::nullopt;
    if (frame->number >= block.first) return frame;
  }
  return std::nullopt;
}

ShardItem item_of(const Outcome& outcome) {
  ShardItem item{.number = outcome.frame.number,
                 .name = outcome.frame.name,
                 .error = outcome.error,
                 .inputs = outcome.inputs,
                 .outputs = outcome.outputs,
                 .result = nullptr};
  if (!outcome.error.empty()) return item;
  item.result = {{"frame", record_of(outcome.frame)},
                 {"read_ms", outcome.read_milliseconds},
                 {"write_ms", outcome.write_milliseconds}};
  return item;
}

Outcome outcome_of(const ShardItem& item) {
  Outcome outcome{.error = item.error, .frame = {.number = item.number, .name = item.name}};
  if (!item.error.empty()) return outcome;
  outcome.frame = frame_of(item.result.at("frame"));
  item.result.at("read_ms").get_to(outcome.read_milliseconds);
  item.result.at("write_ms").get_to(outcome.write_milliseconds);
  return outcome;
}

/// Warns early; the merge judges all frames together.
void warn_of_misfit(const Outcomes& outcomes) {
  const sensing::DecodeJudgement judgement = judge_sequence(outcomes);
  if (judgement.usable()) return;
  spdlog::warn("the frames of this shard do not fit rig, pattern or colours: {}.",
               judgement.reason);
}

}  // namespace

void decode_shard(const Settings& settings, DecodeShardCall call) {
  refuse_videos(call.source.files());
  const Shard& shard = *call.call.shard;
  DecodeOutputs& outputs = call.call.outputs;
  outputs.folder = call.call.output;
  ShardCall shared = shard_call(call.command, call.call.output, shard, call.source.files());
  shared.record = {
      {"settings", call.record_settings}, {"sigma", outputs.sigma}, {"noise", outputs.noise}};
  ShardRun run(shared, shard, numbered_files, [&] {
    if (call.writes_rig) sensing::write_rig(outputs.folder / "rig.yaml", call.decoder.rig());
  });
  if (run.is_finished()) return run.report(settings, "frame");

  const ShardBlock block = block_of(shard, call.source.files().size());
  Progress progress("decoding");
  const InterruptMessage message("shard " + to_string(shard) + " is not finished");
  Outcomes outcomes;
  const auto finished = [&](const Outcome& outcome) {
    if (!outcome.error.empty()) spdlog::error("{}", outcome.error);
    run.add(item_of(outcome));
    outcomes[outcome.frame.number] = outcome;
    progress.show(static_cast<int>(outcomes.size()), static_cast<int>(block.end - block.first));
  };
  decode_frames(
      call.decoder, call.call,
      {.next = [&] { return next_in(block, call.source); }, .begin = [] {}, .finished = finished});
  warn_of_misfit(outcomes);
  run.finish();
  run.report(settings, "frame");
}

void merge_decode_shards(const Settings& settings, const ShardCall& call,
                         const ShardMergeOptions& options) {
  Outcomes outcomes;
  std::vector<fs::path> names;
  const MergedShards merged = read_shards(call, options, [&](const ShardItem& item) {
    names.emplace_back(item.name);
    outcomes[item.number] = outcome_of(item);
  });
  const std::size_t broken = count_broken(outcomes);
  DecodeRecord record(call.output, call.record.at("settings"), names);
  if (merged.missing.empty()) {  // a record means that the sequence is complete
    record.begin();
    for (const auto& [number, outcome] : outcomes) {
      if (outcome.error.empty()) record.add(outcome.frame);
    }
    record.write_table();
  }
  const sensing::DecodeJudgement judgement = judge_sequence(outcomes);
  DecodeOutputs outputs;
  outputs.sigma = call.record.at("sigma");
  outputs.noise = call.record.at("noise");
  report_decoding(settings, call.output, outputs, outcomes, judgement, merged.seconds);
  refuse_misfit(judgement, options.force,
                "What was decoded is in " + call.output.string() +
                    "; to accept it, merge again with --force.");
  refuse_broken(broken, outcomes.size());
}

}  // namespace palpate::apps
