// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <map>
#include <mutex>
#include <nlohmann/json.hpp>

#include "palpate/sensing/recording.h"
#include "shared/result_folder.h"
#include "shared/run_record.h"

namespace palpate::apps {

/// The file in which a recording lists its frames.
inline constexpr const char* kCaptureRecord = "capture.jsonl";

/// The folder of a recording: frame_NNNNNN.tiff, as the camera sent them; capture.jsonl, the
/// settings of the camera, and each frame as soon as it is written; times.csv, the same frames in
/// order. A recording is never replaced.
class CaptureFiles {
 public:
  /// \param settings of the camera.
  /// \throws InvalidInput if the folder already has images or a recording.
  /// \throws OutputError if it cannot be written.
  CaptureFiles(fs::path folder, const Json& settings);

  /// The file of the frame at a place in the recording.
  [[nodiscard]] fs::path file(std::size_t index) const;
  /// Writes a frame. Any thread may call this.
  /// \throws OutputError if the disk is full.
  void write(const sensing::RecordedFrame& frame);
  /// Number of frames that are written.
  [[nodiscard]] std::size_t written() const;
  /// Writes times.csv; nothing if there is no frame.
  /// \throws OutputError.
  void write_table() const;

 private:
  struct Entry {
    std::uint64_t number;
    double time;
  };

  fs::path folder_;
  Json settings_;
  ResultFolder lock_;
  mutable std::mutex mutex_;
  std::optional<RunRecordWriter> record_;  ///< from the first frame on
  std::map<std::size_t, Entry> entries_;
};

}  // namespace palpate::apps
