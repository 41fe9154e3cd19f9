// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shards/shard_journal.h"

#include <fmt/format.h>

#include <fstream>
#include <ostream>
#include <system_error>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/file_fingerprint.h"
#include "palpate/core/file_names.h"
#include "palpate/core/output_file.h"
#include "shared/inputs.h"
#include "shared/run_record.h"

namespace palpate::apps {
namespace {

constexpr const char* kShardsFolder = "shards";
constexpr const char* kJournalKind = "shard of palpate";
constexpr const char* kCallKind = "shards of palpate";

/// File names need not be UTF-8, but JSON must be.
constexpr auto kReplace = Json::error_handler_t::replace;

Json json_of(const std::vector<ShardFile>& files) {
  Json list = Json::array();
  for (const ShardFile& file : files) {
    Json entry = {{"file", file.path}, {"bytes", file.bytes}};
    if (file.modified != 0) entry["modified"] = file.modified;
    entry["digest"] = file.digest;
    list.push_back(std::move(entry));
  }
  return list;
}

std::vector<ShardFile> files_of(const Json& list) {
  std::vector<ShardFile> files;
  for (const Json& entry : list) {
    files.push_back({.path = entry.at("file"),
                     .bytes = entry.at("bytes"),
                     .modified = entry.value("modified", std::int64_t{0}),
                     .digest = entry.at("digest")});
  }
  return files;
}

Json json_of(const ShardItem& item) {
  Json line = {{"item", item.number}, {"name", item.name}, {"inputs", json_of(item.inputs)}};
  if (!item.error.empty()) line["error"] = item.error;
  line["outputs"] = json_of(item.outputs);
  line["result"] = item.result;
  return line;
}

ShardItem item_of(const Json& line) {
  return {.number = line.at("item"),
          .name = line.at("name"),
          .error = line.value("error", std::string()),
          .inputs = files_of(line.at("inputs")),
          .outputs = files_of(line.at("outputs")),
          .result = line.at("result")};
}

ShardJournal journal_of(const fs::path& file, const Shard& shard, const RunRecord& record) {
  const Json& head = record.head;
  if (head.at("kind") != kJournalKind || head.at("shard") != to_string(shard)) {
    throw FileError(
        fmt::format("{}: is not the journal of shard {}.", file.string(), to_string(shard)));
  }
  if (const std::size_t items = head.at("items"); items != record.items.size()) {
    throw FileError(fmt::format("{}: is cut off: it lists {} of its {} items.", file.string(),
                                record.items.size(), items));
  }
  ShardJournal journal{.shard = shard,
                       .settings = head.at("settings"),
                       .host = head.at("host"),
                       .start = head.at("start"),
                       .end = head.at("end"),
                       .seconds = head.at("seconds"),
                       .peak_memory = head.at("peak_memory"),
                       .restarts = head.value("restarts", 0),
                       .items = {}};
  for (const Json& line : record.items) journal.items.push_back(item_of(line));
  return journal;
}

}  // namespace

ShardFile measured(const fs::path& file, const fs::path& folder) {
  std::error_code missing;
  ShardFile found{.path = (folder.empty() ? file : file.lexically_relative(folder)).string(),
                  .bytes = fs::file_size(file, missing),
                  .modified = 0,
                  .digest = {}};
  if (missing) throw FileError(file.string() + ": " + missing.message() + ".");
  if (folder.empty()) found.modified = fs::last_write_time(file).time_since_epoch().count();
  found.digest = file_fingerprint(file);
  return found;
}

std::vector<fs::path> shard_files(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!is_there(folder / kShardsFolder)) return files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder / kShardsFolder)) {
    if (!is_hidden(entry.path())) files.push_back(kShardsFolder / entry.path().filename());
  }
  return files;
}

fs::path journal_file(const fs::path& folder, const Shard& shard) {
  return folder / kShardsFolder / fmt::format("{:04}-of-{:04}.jsonl", shard.index, shard.count);
}

void write_journal(const fs::path& folder, const ShardJournal& journal) {
  RunRecord record{.head = {{"kind", kJournalKind},
                            {"shard", to_string(journal.shard)},
                            {"settings", journal.settings},
                            {"host", journal.host},
                            {"start", journal.start},
                            {"end", journal.end},
                            {"seconds", journal.seconds},
                            {"peak_memory", journal.peak_memory},
                            {"restarts", journal.restarts},
                            {"items", journal.items.size()}},
                   .items = {}};
  for (const ShardItem& item : journal.items) record.items.push_back(json_of(item));
  RunRecordWriter(journal_file(folder, journal.shard), record);
}

std::optional<ShardJournal> read_journal(const fs::path& folder, const Shard& shard) {
  const fs::path file = journal_file(folder, shard);
  if (!is_there(file)) return std::nullopt;
  const char* const remedy = "Run the shard again";
  try {
    return journal_of(file, shard, read_run_record(file, remedy));
  } catch (const Json::exception& error) {
    throw FileError(fmt::format("{}: is not the journal of a shard ({}). {}.", file.string(),
                                error.what(), remedy));
  }
}

void check_same_shards(const fs::path& file, const Json& before, Json now) {
  for (const auto& [name, value] : before.items()) {
    if (!now.contains(name)) now[name] = nullptr;  // given then, but not now
  }
  check_same_settings(file, before, now, "Give another folder for the results");
}

fs::path call_file(const fs::path& folder) { return folder / kShardsFolder / "call.json"; }

void write_call(const ShardCall& call) {
  const Json json = {{"kind", kCallKind},         {"command", call.command},
                     {"words", call.words},       {"directory", call.directory.string()},
                     {"settings", call.settings}, {"record", call.record}};
  write_file(call_file(call.output),
             [&](std::ostream& out) { out << json.dump(1, ' ', false, kReplace) << '\n'; });
}

std::optional<ShardCall> read_call(const fs::path& folder) {
  const fs::path file = call_file(folder);
  if (!is_there(file)) return std::nullopt;
  try {
    std::ifstream stream(file, std::ios::binary);
    const Json json = Json::parse(stream);
    if (json.at("kind") != kCallKind) throw FileError(file.string() + ": is of another program.");
    return ShardCall{.command = json.at("command"),
                     .words = json.at("words"),
                     .directory = json.at("directory").get<std::string>(),
                     .output = folder,
                     .settings = json.at("settings"),
                     .record = json.at("record")};
  } catch (const Json::exception& error) {
    throw FileError(fmt::format(
        "{}: does not say what the shards have in common ({}); make them again in another folder.",
        file.string(), error.what()));
  }
}

}  // namespace palpate::apps
