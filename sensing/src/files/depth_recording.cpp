// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/depth_recording.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"

namespace palpate::sensing {
namespace {

namespace fs = std::filesystem;

/// Without the blanks at both ends, and the \r of a line of Windows.
std::string_view trimmed(std::string_view text) {
  constexpr const char* kBlanks = " \t\r";
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

/// The files of a list by their time [s].
std::map<double, fs::path> read_list(const fs::path& list) {
  std::ifstream in(list);
  if (!in) throw FileError(list.string() + ": cannot be read.");
  std::map<double, fs::path> files;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    std::string_view rest = line;
    const std::string_view time = next_word(rest);
    if (time.empty() || time.starts_with('#')) continue;
    const auto fail = [&](const std::string& message) {
      throw FileError(fmt::format("{}: line {}: {}", list.string(), number, message));
    };
    const std::optional<double> seconds = parse_number<double>(time);
    const std::string_view file = trimmed(rest);
    if (!seconds || !std::isfinite(*seconds) || file.empty())
      fail("a time [s] and the name of a file are expected");
    if (!files.emplace(*seconds, list.parent_path() / file).second)
      fail(fmt::format("the time {} is there twice", time));
  }
  return files;
}

/// The file that is nearest in time, within `kColorDelay`; empty if there is none.
fs::path nearest(const std::map<double, fs::path>& files, double time) {
  const auto after = files.lower_bound(time);
  auto best = files.end();
  double delay = kColorDelay;
  const auto look_at = [&](auto file) {
    if (std::abs(file->first - time) > delay) return;
    delay = std::abs(file->first - time);
    best = file;
  };
  if (after != files.end()) look_at(after);
  if (after != files.begin()) look_at(std::prev(after));
  return best == files.end() ? fs::path() : best->second;
}

}  // namespace

bool is_depth_recording(const fs::path& folder) {
  std::error_code cannot_look;
  return fs::is_regular_file(folder / "depth.txt", cannot_look);
}

std::vector<RecordedDepth> read_depth_recording(const fs::path& folder) {
  const std::map<double, fs::path> depths = read_list(folder / "depth.txt");
  if (depths.empty()) {
    throw FileError((folder / "depth.txt").string() +
                    ": lists no image; each line has a time [s] and the name of a depth image.");
  }
  std::map<double, fs::path> colors;
  std::error_code cannot_look;
  if (fs::exists(folder / "rgb.txt", cannot_look)) colors = read_list(folder / "rgb.txt");
  std::vector<RecordedDepth> recorded;
  for (const auto& [time, file] : depths)
    recorded.push_back(
        {.time = time, .depth = file, .color = nearest(colors, time), .recording = folder});
  return recorded;
}

std::vector<RecordedDepth> DepthRecordings::read(const fs::path& folder) {
  const Listed& recording = listed(folder);
  if (!recording.error.empty()) throw FileError(recording.error);
  return recording.frames;
}

std::optional<RecordedDepth> DepthRecordings::find(const fs::path& depth_image) {
  const fs::path beside = fs::absolute(depth_image).parent_path(), name = depth_image.filename();
  for (const fs::path& folder : {beside, beside.parent_path()}) {
    if (!is_depth_recording(folder)) continue;
    for (const RecordedDepth& frame : listed(folder).frames) {
      std::error_code is_missing;
      if (frame.depth.filename() == name && fs::equivalent(frame.depth, depth_image, is_missing))
        return frame;
    }
  }
  return std::nullopt;
}

const DepthRecordings::Listed& DepthRecordings::listed(const fs::path& folder) {
  const std::scoped_lock lock(mutex_);
  std::error_code cannot_look;
  const fs::path canonical = fs::weakly_canonical(folder, cannot_look);
  const auto [entry, is_new] = by_folder_.try_emplace(cannot_look ? folder : canonical);
  Listed& recording = entry->second;
  if (!is_new) return recording;
  try {
    recording.frames = read_depth_recording(folder);
  } catch (const FileError& error) {
    recording.error = error.what();
  }
  return recording;
}

}  // namespace palpate::sensing
