// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/range_map.h"
#include "palpate/sensing/decode.h"
#include "palpate/sensing/decode_verdict.h"
#include "palpate/sensing/frame_source.h"
#include "shared/run_record.h"

namespace palpate::apps {

/// A frame for which all outputs are written.
struct FinishedFrame {
  std::size_t number = 0;
  std::string name;
  std::uintmax_t bytes = 0;               ///< size of the file that holds the frame
  std::int64_t modified = 0;              ///< time at which that file was last written
  long pixels = 0;                        ///< number of pixels with a depth
  double median_depth = 0;                ///< [mm] NaN if no pixel has a depth
  double milliseconds = 0;                ///< time for decoding
  sensing::DecodeEvidence evidence = {};  ///< of its fit to rig, pattern and colours
};

/// The name of a frame with the size and time of its file, by which a later run detects changes of
/// the file. Both are 0 if the file cannot be examined.
[[nodiscard]] FinishedFrame stamped(const sensing::SourceFrame& frame);

/// Counts the known depths of a range map and computes their median, into the frame's record.
void measure_depths(const geometry::ImageF& z, FinishedFrame& frame);

/// The settings on which range maps depend besides their frames.
struct DecodeSettings {
  std::filesystem::path rig, pattern, colors, response;  ///< empty: not given
  std::string bayer;
  int bits = 0;
  sensing::DecodeOptions options;
};

/// The settings by the names of the options, with fingerprints of the files.
[[nodiscard]] nlohmann::ordered_json decode_settings(DecodeSettings settings);

/// The number of frames that are finished according to a `decode.jsonl`.
/// \throws FileError if it is not a record of `palpate decode`.
[[nodiscard]] std::size_t count_finished_frames(const std::filesystem::path& file);

/// A frame as one line of a record, and back.
/// \throws nlohmann::json::exception if the line is not a frame.
[[nodiscard]] nlohmann::ordered_json record_of(const FinishedFrame& frame);
[[nodiscard]] FinishedFrame frame_of(const nlohmann::ordered_json& json);

/// Lists the files in a folder whose names are those of results of a frame, relative to it.
[[nodiscard]] std::vector<std::filesystem::path> numbered_files(
    const std::filesystem::path& folder);

/// Lists the files that `palpate decode` wrote for the frames in a folder, with names relative to
/// it, and the journals of shards that were merged.
/// \throws InvalidInput if there are such files but no record, so that they may be somebody else's.
[[nodiscard]] std::vector<std::filesystem::path> decoded_files(const std::filesystem::path& folder);

/// Records in `decode.jsonl` which frames of a folder of range maps are finished, for --resume.
///
/// `find` reads only what `resume` read, and `begin` and `add` do not change that: one thread may
/// call `find` while another calls `begin`, `add` or `write_table`. These three must not overlap.
class DecodeRecord {
 public:
  /// \param settings all options on which range maps depend, by name.
  /// \param inputs the files that hold the frames, in their order.
  DecodeRecord(std::filesystem::path folder, nlohmann::ordered_json settings,
               const std::vector<std::filesystem::path>& inputs);

  /// Takes over the frames that an earlier run has finished in this folder, if there was one.
  /// \throws InvalidInput if that run had other settings, or its files are not the first of these;
  /// \throws FileError if its record cannot be read.
  void resume();

  /// Starts the record, before the first range map is written.
  /// \throws OutputError if it cannot be written.
  void begin();

  /// Appends a frame. \pre `begin` was called.
  /// \throws OutputError if the record cannot be written.
  void add(const FinishedFrame& frame);

  /// Writes `frames.csv`: which range map belongs to which frame. Does nothing if no frame
  /// is finished.
  /// \throws OutputError if it cannot be written.
  void write_table() const;

  /// The record of a frame that an earlier run finished.
  /// \return null if there is none, or the frame's file has changed since.
  [[nodiscard]] const FinishedFrame* find(const sensing::SourceFrame& frame) const;

  /// The number of frames that are finished, in this run or an earlier one. Must not overlap with
  /// `add`.
  [[nodiscard]] std::size_t finished() const;

 private:
  [[nodiscard]] std::filesystem::path file() const;
  void check_inputs(const nlohmann::ordered_json& head) const;

  std::filesystem::path folder_;
  nlohmann::ordered_json settings_;
  std::vector<std::string> inputs_;               ///< names of the files
  std::map<std::size_t, FinishedFrame> earlier_;  ///< constant after `resume`
  std::map<std::size_t, std::string> added_;      ///< names by number
  std::optional<RunRecordWriter> writer_;         ///< after `begin`
};

}  // namespace palpate::apps
