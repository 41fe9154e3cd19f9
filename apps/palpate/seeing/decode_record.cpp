// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/decode_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <ostream>
#include <system_error>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/file_fingerprint.h"
#include "palpate/core/output_file.h"
#include "palpate/core/quantile.h"
#include "palpate/probing/csv.h"
#include "seeing/decode_outputs.h"
#include "shards/shard_journal.h"
#include "shared/field_options.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kDecodeFile = "decode.jsonl";
constexpr const char* kDecodeTable = "frames.csv";
constexpr const char* kDecodeRecord = "frames of palpate decode";

/// The remedy if the record cannot be used, for messages.
constexpr const char* kDecodeRemedy = "Leave out --resume to decode all frames again";

Json to_json(const sensing::DepthTrend& trend) {
  return {{"edges", trend.edges},
          {"disparity", trend.disparity},
          {"disparity_squares", trend.disparity_squares},
          {"shift", trend.shift},
          {"products", trend.products}};
}

sensing::DepthTrend trend_of(const Json& json) {
  return {.edges = json.at("edges"),
          .disparity = json.at("disparity"),
          .disparity_squares = json.at("disparity_squares"),
          .shift = json.at("shift"),
          .products = json.at("products")};
}

Json to_json(const sensing::DecodeEvidence& evidence) {
  return {{"edges", evidence.edges},
          {"off_panel", evidence.off_panel},
          {"stripe_edges", evidence.stripe_edges},
          {"agreement", evidence.agreement},
          {"shift", evidence.shift},
          {"steady_edges", evidence.steady_edges},
          {"displaced_edges", evidence.displaced_edges},
          {"rows", evidence.rows},
          {"trend", to_json(evidence.trend)},
          {"neighbours", evidence.neighbours},
          {"smoothness", evidence.smoothness},
          {"explained", evidence.explained},
          {"explained_edges", evidence.explained_edges},
          {"light", evidence.light},
          {"lit", evidence.lit},
          {"across", evidence.across},
          {"hues", evidence.hues},
          {"trained_hues", evidence.trained_hues},
          {"steps_in_pairs", evidence.steps_in_pairs},
          {"steps_between_pairs", evidence.steps_between_pairs},
          {"colors_fit_pattern", evidence.colors_fit_pattern}};
}

sensing::DecodeEvidence evidence_of(const Json& json) {
  sensing::DecodeEvidence evidence;
  json.at("edges").get_to(evidence.edges);
  json.at("off_panel").get_to(evidence.off_panel);
  json.at("stripe_edges").get_to(evidence.stripe_edges);
  json.at("agreement").get_to(evidence.agreement);
  json.at("shift").get_to(evidence.shift);
  json.at("steady_edges").get_to(evidence.steady_edges);
  json.at("displaced_edges").get_to(evidence.displaced_edges);
  json.at("rows").get_to(evidence.rows);
  evidence.trend = trend_of(json.at("trend"));
  json.at("neighbours").get_to(evidence.neighbours);
  json.at("smoothness").get_to(evidence.smoothness);
  json.at("explained").get_to(evidence.explained);
  json.at("explained_edges").get_to(evidence.explained_edges);
  json.at("light").get_to(evidence.light);
  json.at("lit").get_to(evidence.lit);
  json.at("across").get_to(evidence.across);
  json.at("hues").get_to(evidence.hues);
  json.at("trained_hues").get_to(evidence.trained_hues);
  json.at("steps_in_pairs").get_to(evidence.steps_in_pairs);
  json.at("steps_between_pairs").get_to(evidence.steps_between_pairs);
  json.at("colors_fit_pattern").get_to(evidence.colors_fit_pattern);
  return evidence;
}

using FinishedFrames = std::map<std::size_t, FinishedFrame>;

/// The frames in a record, by number. A frame that was decoded again has two lines.
/// \throws nlohmann::json::exception if an item is not a frame.
FinishedFrames frames_of(const RunRecord& record) {
  FinishedFrames frames;
  for (const Json& item : record.items) {
    const FinishedFrame frame = frame_of(item);
    frames[frame.number] = frame;
  }
  return frames;
}

FileError no_record(const fs::path& file, const Json::exception& error, const char* remedy) {
  return FileError(fmt::format("{}: this is not a record of palpate decode ({}). {}.",
                               file.string(), error.what(), remedy));
}

}  // namespace

Json decode_settings(DecodeSettings settings) {
  const auto print_of = [](const fs::path& file) {
    return file.empty() ? "" : file_fingerprint(file);
  };
  Json named = {{"version", PALPATE_VERSION},
                {"--rig", print_of(settings.rig)},
                {"--pattern", print_of(settings.pattern)},
                {"--colors", print_of(settings.colors)},
                {"--response", print_of(settings.response)},
                {"--bayer", settings.bayer},
                {"--bits", settings.bits}};
  named.update(option_values(fields_of(settings.options)));
  return named;
}

Json record_of(const FinishedFrame& frame) {
  return {{"number", frame.number},   {"frame", frame.name},
          {"bytes", frame.bytes},     {"modified", frame.modified},
          {"pixels", frame.pixels},   {"median_depth", frame.median_depth},
          {"ms", frame.milliseconds}, {"evidence", to_json(frame.evidence)}};
}

FinishedFrame frame_of(const Json& json) {
  const Json& depth = json.at("median_depth");  // JSON has no NaN and writes null
  return {.number = json.at("number"),
          .name = json.at("frame"),
          .bytes = json.at("bytes"),
          .modified = json.at("modified"),
          .pixels = json.at("pixels"),
          .median_depth =
              depth.is_null() ? std::numeric_limits<double>::quiet_NaN() : depth.get<double>(),
          .milliseconds = json.at("ms"),
          .evidence = evidence_of(json.at("evidence"))};
}

std::size_t count_finished_frames(const fs::path& file) {
  constexpr const char* kWanted = "Give the decode.jsonl that palpate decode has written";
  try {
    return frames_of(read_run_record(file, kWanted)).size();
  } catch (const Json::exception& error) {
    throw no_record(file, error, kWanted);
  }
}

std::vector<fs::path> numbered_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    if (is_numbered(entry.path().filename())) files.push_back(entry.path().filename());
  }
  return files;
}

std::vector<fs::path> decoded_files(const fs::path& folder) {
  std::vector<fs::path> files = numbered_files(folder);
  const std::vector<fs::path> shards = shard_files(folder);
  if (is_there(folder / kDecodeFile)) {
    files.insert(files.end(), shards.begin(), shards.end());
    return files;
  }
  if (!shards.empty()) {
    throw InvalidInput(folder.string() +
                       ": holds shards that are not merged yet; palpate merge-shards does that. "
                       "Give another folder, or remove this one.");
  }
  if (is_there(folder / kDecodeTable)) files.insert(files.begin(), kDecodeTable);
  if (files.empty()) return files;
  throw InvalidInput((folder / files.front()).string() +
                     ": would be replaced, but the folder has no decode.jsonl, which shows that "
                     "palpate decode wrote it. Nothing was changed. Give a new or an empty "
                     "folder, or remove the file.");
}

FinishedFrame stamped(const sensing::SourceFrame& frame) {
  FinishedFrame stamp{.number = frame.number, .name = frame.name};
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(frame.file, error);
  if (!error) stamp.bytes = bytes;
  const fs::file_time_type time = fs::last_write_time(frame.file, error);
  if (!error) stamp.modified = time.time_since_epoch().count();
  return stamp;
}

void measure_depths(const geometry::ImageF& z, FinishedFrame& frame) {
  std::vector<float> depths;
  depths.reserve(static_cast<std::size_t>(z.size()));
  std::copy_if(z.data(), z.data() + z.size(), std::back_inserter(depths),
               [](float depth) { return depth > 0; });
  frame.pixels = static_cast<long>(depths.size());
  frame.median_depth = std::numeric_limits<double>::quiet_NaN();
  if (depths.empty()) return;
  frame.median_depth = static_cast<double>(median(depths));
}

DecodeRecord::DecodeRecord(fs::path folder, Json settings, const std::vector<fs::path>& inputs)
    : folder_(std::move(folder)), settings_(std::move(settings)) {
  for (const fs::path& file : inputs) inputs_.push_back(file.filename().string());
}

fs::path DecodeRecord::file() const { return folder_ / kDecodeFile; }

void DecodeRecord::check_inputs(const Json& head) const {
  const auto before = head.at("inputs").get<std::vector<std::string>>();
  for (std::size_t i = 0; i < before.size(); ++i) {
    const std::string now = i < inputs_.size() ? "is now " + inputs_[i] : "is now missing";
    if (i < inputs_.size() && before[i] == inputs_[i]) continue;
    throw InvalidInput(
        fmt::format("{}: file {} of the frames was {} and {}, so the numbers of the range maps "
                    "would not fit. New frames may only follow the old ones. {}.",
                    file().string(), i, before[i], now, kDecodeRemedy));
  }
}

void DecodeRecord::resume() {
  if (!is_there(file())) return;
  const RunRecord record = read_run_record(file(), kDecodeRemedy);
  try {
    check_same_settings(file(), record.head.at("settings"), settings_, kDecodeRemedy);
    check_inputs(record.head);
    earlier_ = frames_of(record);
  } catch (const Json::exception& error) {
    throw no_record(file(), error, kDecodeRemedy);
  }
}

void DecodeRecord::begin() {
  RunRecord record{.head = {{"kind", kDecodeRecord}, {"settings", settings_}, {"inputs", inputs_}},
                   .items = {}};
  for (const auto& [number, frame] : earlier_) record.items.push_back(record_of(frame));
  writer_.emplace(file(), record);
}

void DecodeRecord::add(const FinishedFrame& frame) {
  writer_->add(record_of(frame));
  added_[frame.number] = frame.name;
}

void DecodeRecord::write_table() const {
  if (finished() == 0) return;
  std::map<std::size_t, std::string> names = added_;
  for (const auto& [number, frame] : earlier_) names.try_emplace(number, frame.name);
  write_file(folder_ / kDecodeTable, [&](std::ostream& out) {
    out << "range_map,frame\n";
    for (const auto& [number, name] : names)
      out << numbered({}, number, ".tiff").string() << ',' << probing::to_cell(name) << '\n';
  });
}

std::size_t DecodeRecord::finished() const {
  return earlier_.size() +
         static_cast<std::size_t>(std::ranges::count_if(
             added_, [&](const auto& entry) { return !earlier_.contains(entry.first); }));
}

const FinishedFrame* DecodeRecord::find(const sensing::SourceFrame& frame) const {
  const auto found = earlier_.find(frame.number);
  if (found == earlier_.end()) return nullptr;
  const FinishedFrame now = stamped(frame);
  const FinishedFrame& then = found->second;
  const bool is_same =
      then.name == now.name && then.bytes == now.bytes && then.modified == now.modified;
  return is_same ? &then : nullptr;
}

}  // namespace palpate::apps
