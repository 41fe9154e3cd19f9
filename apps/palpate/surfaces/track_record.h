// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "palpate/geometry/surface_tracker.h"
#include "shared/run_record.h"

namespace palpate::apps {

/// The result of one range map.
struct TrackedFrame {
  std::string range_map;                   ///< name of its file
  std::string fingerprint;                 ///< of all files that it depends on
  std::string lost;                        ///< why the surface was not found; empty if it was
  geometry::TrackingFigures figures = {};  ///< of a frame that is not lost
};

/// The members of a frame as in the record.
[[nodiscard]] Json to_json(const TrackedFrame& frame);

/// Lists the files that `palpate track` wrote for the range maps of an earlier run, with paths
/// relative to `folder`.
/// \throws InvalidInput if the folder holds a mesh that no record claims, or a file where a record
/// is to be written.
[[nodiscard]] std::vector<fs::path> tracked_files(const fs::path& folder);

/// Returns the range maps in which the surface was lost, for a folder that `palpate track` wrote;
/// none if the folder has no record, such as that of another command.
/// \throws FileError if the record cannot be read.
[[nodiscard]] std::vector<std::string> lost_frames(const fs::path& folder);

/// Records in `track.jsonl`, beside the meshes, which frames are finished, for --resume.
class TrackRecord {
 public:
  /// `settings`: by name, all that the meshes depend on besides the range maps `inputs`.
  TrackRecord(fs::path folder, Json settings, std::vector<fs::path> inputs);

  /// Takes over the frames that an earlier run finished, up to the first one that would differ
  /// now: each frame depends on the one before.
  /// \param is_kept returns true if the range map of a frame has not changed and all outputs exist.
  /// \throws InvalidInput unless settings and range maps are the same (range maps may be added at
  /// the end).
  /// \throws FileError if the record cannot be read.
  void resume(const std::function<bool(const TrackedFrame&, const fs::path&)>& is_kept);

  /// The frames so far: those that are taken over, which are of the first range maps, and those
  /// that were added.
  [[nodiscard]] const std::vector<TrackedFrame>& frames() const { return frames_; }
  /// Number of frames that are taken over.
  [[nodiscard]] std::size_t kept() const { return kept_; }
  /// Number of frames that are written, with those that are taken over.
  [[nodiscard]] std::size_t written() const { return written_; }

  /// Starts the record with the frames that are kept. Later calls do nothing.
  /// \throws OutputError.
  void begin();

  void add(TrackedFrame frame) { frames_.push_back(std::move(frame)); }
  /// Writes the frames that were added.
  /// \throws OutputError.
  void write();

 private:
  [[nodiscard]] fs::path path() const;
  void check_inputs(const Json& head) const;

  fs::path folder_;
  Json settings_;
  std::vector<fs::path> inputs_;
  std::vector<TrackedFrame> frames_;
  std::size_t kept_ = 0, written_ = 0;     ///< of `frames_`
  std::optional<RunRecordWriter> writer_;  ///< after `begin`
};

}  // namespace palpate::apps
