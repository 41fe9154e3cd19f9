// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "commands/decode_record.h"

#include <fmt/format.h>

#include <fstream>
#include <limits>
#include <ostream>
#include <system_error>
#include <utility>

#include "commands/decode_outputs.h"
#include "palpate/error.h"
#include "palpate/output_file.h"
#include "palpate/probing/csv.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr auto kWritingPause = std::chrono::seconds(1);

/// What a run without --resume would do, for messages.
constexpr const char* kAnew = "Leave out --resume to decode all frames anew";

Json to_json(const FinishedFrame& frame) {
  return {{"number", frame.number},  {"frame", frame.name},
          {"bytes", frame.bytes},    {"modified", frame.modified},
          {"pixels", frame.pixels},  {"median_depth", frame.median_depth},
          {"ms", frame.milliseconds}};
}

FinishedFrame from_json(const Json& json) {
  const Json& depth = json.at("median_depth");  // JSON has no NaN, and writes null
  return {.number = json.at("number"),
          .name = json.at("frame"),
          .bytes = json.at("bytes"),
          .modified = json.at("modified"),
          .pixels = json.at("pixels"),
          .median_depth =
              depth.is_null() ? std::numeric_limits<double>::quiet_NaN() : depth.get<double>(),
          .milliseconds = json.at("ms")};
}

}  // namespace

FinishedFrame stamped(const sensing::SourceFrame& frame) {
  FinishedFrame stamp{.number = frame.number, .name = frame.name};
  std::error_code error;
  const std::uintmax_t bytes = fs::file_size(frame.file, error);
  if (!error) stamp.bytes = bytes;
  const fs::file_time_type time = fs::last_write_time(frame.file, error);
  if (!error) stamp.modified = time.time_since_epoch().count();
  return stamp;
}

DecodeRecord::DecodeRecord(fs::path folder, Json settings, std::vector<std::string> inputs)
    : folder_(std::move(folder)), settings_(std::move(settings)), inputs_(std::move(inputs)) {}

void DecodeRecord::check_same(const Json& earlier) const {
  const Json& before = earlier.at("settings");
  for (const auto& [name, value] : settings_.items()) {
    if (before.contains(name) && before.at(name) == value) continue;
    throw InvalidInput(fmt::format(
        "{}: the frames that are finished were decoded with another {}. {}, or give the same.",
        file().string(), name, kAnew));
  }
  const auto inputs = earlier.at("inputs").get<std::vector<std::string>>();
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::string now = i < inputs_.size() ? "now it is " + inputs_[i] : "now there is none";
    if (i < inputs_.size() && inputs[i] == inputs_[i]) continue;
    throw InvalidInput(fmt::format(
        "{}: file {} of the frames was {}, {}; the numbers of the range maps would not fit. {}; "
        "frames may only be added at the end.",
        file().string(), i, inputs[i], now, kAnew));
  }
}

void DecodeRecord::resume() {
  resumed_ = is_there(file());
  if (!resumed_) return;
  std::ifstream stream(file(), std::ios::binary);
  try {
    const Json earlier = Json::parse(stream);
    check_same(earlier);
    for (const Json& entry : earlier.at("frames")) {
      const FinishedFrame frame = from_json(entry);
      frames_[frame.number] = frame;
    }
  } catch (const Json::exception& error) {
    throw FileError(fmt::format("{}: is not the record of an earlier run ({}). {}.",
                                file().string(), error.what(), kAnew));
  }
}

void DecodeRecord::begin() {
  const bool is_claimed = is_there(file());
  if (!resumed_ && is_there(folder_)) {
    if (!is_claimed && is_there(folder_ / "frames.csv")) {
      throw InvalidInput((folder_ / "frames.csv").string() +
                         ": would be replaced, and no decode.json says that it comes from an "
                         "earlier run; nothing is changed. Give a new or an empty folder.");
    }
    std::vector<fs::path> old;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder_)) {
      if (!is_numbered(entry.path().filename())) continue;
      if (!is_claimed) {
        throw InvalidInput(
            entry.path().string() +
            ": lies where range maps are to be written, and no decode.json says that it comes from "
            "an earlier run; nothing is changed. Give a new or an empty folder, or remove it.");
      }
      old.push_back(entry.path());
    }
    for (const fs::path& path : old) fs::remove(path);
  }
  write();
}

void DecodeRecord::add(const FinishedFrame& frame) {
  frames_[frame.number] = frame;
  if (std::chrono::steady_clock::now() - written_ > kWritingPause) write();
}

void DecodeRecord::write() {
  Json entries = Json::array();
  for (const auto& [number, frame] : frames_) entries.push_back(to_json(frame));
  const Json record = {{"settings", settings_}, {"inputs", inputs_}, {"frames", entries}};
  write_file(file(), [&](std::ostream& out) {
    out << record.dump(1, ' ', false, Json::error_handler_t::replace) << '\n';
  });
  write_file(folder_ / "frames.csv", [&](std::ostream& out) {
    out << "range_map,frame\n";
    for (const auto& [number, frame] : frames_)
      out << numbered({}, number, ".tiff").string() << ',' << probing::to_cell(frame.name) << '\n';
  });
  written_ = std::chrono::steady_clock::now();
}

const FinishedFrame* DecodeRecord::find(const sensing::SourceFrame& frame) const {
  const auto found = frames_.find(frame.number);
  if (found == frames_.end()) return nullptr;
  const FinishedFrame now = stamped(frame);
  const FinishedFrame& then = found->second;
  const bool is_same =
      then.name == now.name && then.bytes == now.bytes && then.modified == now.modified;
  return is_same ? &then : nullptr;
}

}  // namespace palpate::apps
