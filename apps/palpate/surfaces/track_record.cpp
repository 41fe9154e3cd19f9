// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/track_record.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <set>

#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

constexpr const char* kTrackFile = "track.jsonl";
constexpr const char* kTrackRecord = "frames of palpate track";

/// The remedy if the record cannot be used, for messages.
constexpr const char* kTrackRemedy = "Leave out --resume to track all frames again";

/// NaN is null in JSON.
double number_or_nan(const Json& json, const char* key) {
  const Json& value = json.at(key);
  return value.is_null() ? std::numeric_limits<double>::quiet_NaN() : value.get<double>();
}

TrackedFrame tracked_frame(const Json& json) {
  TrackedFrame frame{
      .range_map = json.at("range_map"), .fingerprint = json.at("fingerprint"), .lost = {}};
  if (json.contains("lost")) {
    frame.lost = json.at("lost");
    return frame;
  }
  frame.figures = {.rms = number_or_nan(json, "rms"),
                   .p95 = number_or_nan(json, "p95"),
                   .max = number_or_nan(json, "max"),
                   .measured = json.at("measured"),
                   .visible = json.at("visible"),
                   .stretch = json.at("stretch"),
                   .sigma_across = number_or_nan(json, "sigma_across"),
                   .sigma_along = number_or_nan(json, "sigma_along"),
                   .iterations = json.at("iterations"),
                   .settled = json.at("settled")};
  return frame;
}

/// The first line of a record; null if there is none.
Json read_head(const fs::path& record) {
  std::ifstream stream(record, std::ios::binary);
  std::string line;
  std::getline(stream, line);
  Json head = Json::parse(line, nullptr, false);
  return head.is_object() && head.contains("kind") && head["kind"] == kTrackRecord ? head : Json();
}

/// The names, without endings, of the range maps of a record: those that were there when it began,
/// and those that came later.
std::set<std::string> claimed_stems(const fs::path& record, const Json& head) {
  std::set<std::string> stems;
  if (!head.contains("inputs")) return stems;
  std::ifstream stream(record, std::ios::binary);
  for (std::string line; std::getline(stream, line);) {
    const Json frame = Json::parse(line, nullptr, false);
    if (frame.is_object() && frame.contains("range_map") && frame["range_map"].is_string())
      stems.insert(fs::path(frame["range_map"].get<std::string>()).stem().string());
  }
  for (const Json& input : head.at("inputs"))
    stems.insert(fs::path(input.get<std::string>()).stem().string());
  return stems;
}

}  // namespace

std::vector<fs::path> tracked_files(const fs::path& folder) {
  const fs::path record = folder / kTrackFile;
  const Json head = read_head(record);
  if (is_there(record) && head.is_null()) {
    throw InvalidInput(record.string() +
                       ": would be replaced, and is not a record of palpate track; nothing is "
                       "changed. Give a new or an empty folder, or remove it.");
  }
  const std::set<std::string> claimed = claimed_stems(record, head);
  std::vector<fs::path> files;
  for (const fs::path& place : {folder, folder / "nodes"}) {
    if (!is_there(place) || !is_folder(place)) continue;
    for (const fs::directory_entry& entry : fs::directory_iterator(place)) {
      const fs::path& file = entry.path();
      const bool may_be_result =
          file.extension() == ".ply" || file.extension() == ".obj" || file.extension() == ".png";
      if (is_hidden(file) || !may_be_result) continue;
      if (!claimed.contains(file.stem().string())) {
        throw InvalidInput(file.string() +
                           ": lies where meshes are to be written, and no track.jsonl says that it "
                           "comes from an earlier run; nothing is changed. Give a new or an empty "
                           "folder, or remove it.");
      }
      files.push_back(file.lexically_relative(folder));
    }
  }
  return files;
}

std::vector<std::string> lost_frames(const fs::path& folder) {
  const fs::path record = folder / kTrackFile;
  std::vector<std::string> lost;
  if (read_head(record).is_null()) return lost;
  try {
    for (const Json& item : read_run_record(record, kTrackRemedy).items)
      if (item.contains("lost")) lost.push_back(item.at("range_map"));
  } catch (const Json::exception& error) {
    throw FileError(fmt::format("{}: this is not a record of palpate track ({}).", record.string(),
                                error.what()));
  }
  return lost;
}

Json to_json(const TrackedFrame& frame) {
  Json json = {{"range_map", frame.range_map}, {"fingerprint", frame.fingerprint}};
  if (!frame.lost.empty()) {
    json["lost"] = frame.lost;
    return json;
  }
  const geometry::TrackingFigures& figures = frame.figures;
  json["rms"] = figures.rms;
  json["p95"] = figures.p95;
  json["max"] = figures.max;
  json["measured"] = figures.measured;
  json["visible"] = figures.visible;
  json["stretch"] = figures.stretch;
  json["sigma_across"] = figures.sigma_across;
  json["sigma_along"] = figures.sigma_along;
  json["iterations"] = figures.iterations;
  json["settled"] = figures.settled;
  return json;
}

TrackRecord::TrackRecord(fs::path folder, Json settings, std::vector<fs::path> inputs)
    : folder_(std::move(folder)), settings_(std::move(settings)), inputs_(std::move(inputs)) {}

fs::path TrackRecord::path() const { return folder_ / kTrackFile; }

void TrackRecord::check_inputs(const Json& head) const {
  const auto before = head.at("inputs").get<std::vector<std::string>>();
  for (std::size_t i = 0; i < before.size(); ++i) {
    if (i < inputs_.size() && before[i] == inputs_[i].filename()) continue;
    throw InvalidInput(fmt::format(
        "{}: range map {} was {} and is now {}. New range maps may only follow the old ones. {}.",
        path().string(), i, before[i],
        i < inputs_.size() ? inputs_[i].filename().string() : std::string("missing"),
        kTrackRemedy));
  }
}

void TrackRecord::resume(const std::function<bool(const TrackedFrame&, const fs::path&)>& is_kept) {
  if (!is_there(path())) return;
  const RunRecord record = read_run_record(path(), kTrackRemedy);
  try {
    check_same_settings(path(), record.head.at("settings"), settings_, kTrackRemedy);
    check_inputs(record.head);
    for (std::size_t i = 0; i < std::min(record.items.size(), inputs_.size()); ++i) {
      const TrackedFrame frame = tracked_frame(record.items[i]);
      if (frame.range_map != inputs_[i].filename() || !is_kept(frame, inputs_[i])) break;
      frames_.push_back(frame);
    }
  } catch (const Json::exception& error) {
    throw FileError(fmt::format("{}: this is not a record of palpate track ({}). {}.",
                                path().string(), error.what(), kTrackRemedy));
  }
  kept_ = written_ = frames_.size();
}

void TrackRecord::begin() {
  if (writer_) return;
  Json names = Json::array();
  for (const fs::path& input : inputs_) names.push_back(input.filename().string());
  RunRecord record{.head = {{"kind", kTrackRecord}, {"settings", settings_}, {"inputs", names}},
                   .items = {}};
  for (std::size_t i = 0; i < kept_; ++i) record.items.push_back(to_json(frames_[i]));
  writer_.emplace(path(), record);
}

void TrackRecord::write() {
  begin();
  for (; written_ < frames_.size(); ++written_) writer_->add(to_json(frames_[written_]));
}

}  // namespace palpate::apps
