// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/depth_recording.h"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>
#include <string>
#include <system_error>

#include "palpate/core/error.h"

namespace palpate::sensing {
namespace {

namespace fs = std::filesystem;

/// The files of a list by their time [s].
std::map<double, fs::path> read_list(const fs::path& list) {
  std::ifstream in(list);
  if (!in) throw FileError(list.string() + ": cannot be read.");
  std::map<double, fs::path> files;
  std::string line;
  for (int number = 1; std::getline(in, line); ++number) {
    std::istringstream words(line);
    std::string time, file;
    if (!(words >> time) || time.starts_with('#')) continue;
    const auto fail = [&](const std::string& message) {
      throw FileError(fmt::format("{}: line {}: {}", list.string(), number, message));
    };
    char* end = nullptr;
    const double seconds = std::strtod(time.c_str(), &end);
    if (*end != '\0' || !std::isfinite(seconds) || !(words >> file))
      fail("a time [s] and the name of a file are expected");
    if (!files.emplace(seconds, list.parent_path() / file).second)
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
    recorded.push_back({.time = time, .depth = file, .color = nearest(colors, time)});
  return recorded;
}

}  // namespace palpate::sensing
