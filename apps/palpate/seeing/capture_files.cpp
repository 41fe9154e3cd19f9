// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/capture_files.h"

#include <fmt/format.h>

#include <ostream>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/file_names.h"
#include "palpate/core/output_file.h"
#include "palpate/sensing/frame.h"
#include "palpate/sensing/tiff_frame.h"

namespace palpate::apps {
namespace {

constexpr const char* kCaptureTable = "times.csv";

/// A recording cannot be repeated, so nothing is listed that may be replaced.
std::vector<fs::path> refuse_recording(const fs::path& folder) {
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path name = entry.path().filename();
    if (is_hidden(name)) continue;
    if (name == kCaptureRecord || sensing::has_frame_name(name)) {
      throw InvalidInput(entry.path().string() +
                         ": the folder already holds frames, and a recording is never replaced. "
                         "Give a new folder, or remove these yourself.");
    }
  }
  return {};
}

}  // namespace

CaptureFiles::CaptureFiles(fs::path folder, const Json& settings)
    : folder_(std::move(folder)),
      settings_(settings),
      lock_(folder_, refuse_recording, ResultFolder::Unfinished::kept) {}

fs::path CaptureFiles::file(std::size_t index) const {
  return folder_ / fmt::format("frame_{:06}.tiff", index);
}

void CaptureFiles::write(const sensing::RecordedFrame& frame) {
  const fs::path path = file(frame.index);
  sensing::write_tiff(path, frame.image);
  const std::lock_guard lock(mutex_);
  if (!record_) {
    record_.emplace(folder_ / kCaptureRecord,
                    RunRecord{.head = {{"kind", "frames of palpate capture"},
                                       {"version", PALPATE_VERSION},
                                       {"camera", settings_}},
                              .items = {}});
  }
  record_->add(
      {{"file", path.filename().string()}, {"number", frame.number}, {"time_s", frame.time}});
  entries_[frame.index] = {.number = frame.number, .time = frame.time};
}

std::size_t CaptureFiles::written() const {
  const std::lock_guard lock(mutex_);
  return entries_.size();
}

void CaptureFiles::write_table() const {
  const std::lock_guard lock(mutex_);
  if (entries_.empty()) return;
  write_file(folder_ / kCaptureTable, [&](std::ostream& out) {
    out << "file,number,time_s\n";
    for (const auto& [index, entry] : entries_) {
      out << fmt::format("{},{},{:.6f}\n", file(index).filename().string(), entry.number,
                         entry.time);
    }
  });
}

}  // namespace palpate::apps
