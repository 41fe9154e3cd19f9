// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/motion_sequence.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <regex>
#include <string>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "shared/inputs.h"

namespace palpate::apps {
namespace {

// [frames] The integer at the end of a name, such as that of 000012.ply. Decimals do not count, and
// neither do more than nine digits, which are a time in some unit.
std::optional<double> frame_number(const fs::path& file) {
  static const std::regex kNumber("(?:.*[^0-9])?([0-9]{1,9})"), kDecimals(".*[0-9][.][0-9]+");
  const std::string name = file.stem().string();
  std::smatch match;
  if (std::regex_match(name, kDecimals) || !std::regex_match(name, match, kNumber))
    return std::nullopt;
  return parse_number<double>(match.str(1));
}

// [s] The time in a name, such as that of 1305031102.160407.ply, a frame of TUM RGB-D.
std::optional<double> time_stamp(const fs::path& file) {
  static const std::regex kTime("[0-9]+[.][0-9]+");
  const std::string name = file.stem().string();
  return std::regex_match(name, kTime) ? parse_number<double>(name) : std::nullopt;
}

/// The files with their times; none unless all have one.
template <typename TimeOf>
std::vector<MotionFrame> with_times(const std::vector<fs::path>& files, const TimeOf& time_of) {
  std::vector<MotionFrame> frames;
  for (const fs::path& file : files) {
    const std::optional<double> time = time_of(file);
    if (!time) return {};
    frames.push_back({file, *time});
  }
  return frames;
}

/// Returns true if the times increase from each frame to the next.
bool advances(const std::vector<MotionFrame>& frames) {
  return !frames.empty() && std::ranges::adjacent_find(frames, std::greater_equal<>(),
                                                       &MotionFrame::time) == frames.end();
}

MotionSequence since_first(std::vector<MotionFrame> frames, bool has_seconds) {
  const double first = frames.front().time;
  for (MotionFrame& frame : frames) frame.time -= first;
  return {.frames = std::move(frames), .has_seconds = has_seconds};
}

}  // namespace

MotionSequence motion_sequence(const fs::path& folder) {
  const std::vector<fs::path> files = list_meshes(folder);
  if (files.empty()) {
    throw FileError(folder.string() + ": has no meshes; give a folder as palpate track writes it");
  }
  std::vector<MotionFrame> timed = with_times(files, time_stamp);
  std::ranges::sort(timed, {}, &MotionFrame::time);
  if (advances(timed)) return since_first(std::move(timed), true);
  std::vector<MotionFrame> numbered = with_times(files, frame_number);
  if (advances(numbered)) return since_first(std::move(numbered), false);
  MotionSequence sequence;
  for (const fs::path& file : files)
    sequence.frames.push_back({file, static_cast<double>(sequence.frames.size())});
  return sequence;
}

std::optional<double> frame_rate(const MotionSequence& sequence,
                                 const std::optional<double>& rate) {
  if (!sequence.has_seconds) return rate;
  if (rate) {
    throw InvalidInput(sequence.frames.front().file.string() +
                       ": the names of the meshes are times in seconds; leave out --rate");
  }
  return 1.0;
}

geometry::MeshFile read_motion_frame(const fs::path& file, const geometry::TriangleMesh& reference,
                                     const geometry::ReadOptions& options) {
  geometry::MeshFile frame = geometry::read_mesh_file(file, options);
  if (frame.mesh.triangles != reference.triangles ||
      frame.mesh.vertices.cols() != reference.vertices.cols()) {
    throw FileError(fmt::format(
        "{}: has {} vertices and {} triangles, not the same as the reference or the first mesh ({} "
        "and {}); all meshes must have the same triangles and the same order of vertices, as "
        "palpate track writes them",
        file.string(), frame.mesh.vertices.cols(), frame.mesh.triangles.cols(),
        reference.vertices.cols(), reference.triangles.cols()));
  }
  return frame;
}

}  // namespace palpate::apps
