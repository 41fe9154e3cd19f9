// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "palpate/sensing/frame_source.h"

namespace palpate::apps {

/// A frame whose range map is written.
struct FinishedFrame {
  std::size_t number = 0;
  std::string name;
  std::uintmax_t bytes = 0;   ///< of the file that it came from, as is
  std::int64_t modified = 0;  ///< when that was written
  long pixels = 0;            ///< with a depth
  double median_depth = 0;    ///< [mm] NaN if there is none
  double milliseconds = 0;    ///< for decoding
};

/// Of the frame's file: whether it changed since is seen from them. 0 where it cannot be looked at.
[[nodiscard]] FinishedFrame stamped(const sensing::SourceFrame& frame);

/// What made the range maps of a folder, and which are finished: decode.json, and frames.csv for
/// people. Both are whole at any time, and at most a second behind.
class DecodeRecord {
 public:
  /// `settings`: by name, all that range maps depend on besides the frames; `inputs`: the files.
  DecodeRecord(std::filesystem::path folder, nlohmann::ordered_json settings,
               std::vector<std::string> inputs);

  /// Takes over what an earlier run finished; without one there is nothing to take over.
  /// \throws InvalidInput unless its settings are the same and its inputs the first of these;
  /// FileError if its record cannot be read.
  void resume();

  /// Before the first range map is written. Unless resumed, files of an earlier run are removed,
  /// so that the folder never holds frames of two sequences.
  /// \throws InvalidInput if there are range maps that no record claims.
  void begin();

  void add(const FinishedFrame& frame);
  /// \throws OutputError.
  void write();

  /// Null if it is not finished, or its file is another now.
  [[nodiscard]] const FinishedFrame* find(const sensing::SourceFrame& frame) const;

 private:
  [[nodiscard]] std::filesystem::path file() const { return folder_ / "decode.json"; }
  void check_same(const nlohmann::ordered_json& earlier) const;

  std::filesystem::path folder_;
  nlohmann::ordered_json settings_;
  std::vector<std::string> inputs_;
  std::map<std::size_t, FinishedFrame> frames_;
  bool resumed_ = false;
  std::chrono::steady_clock::time_point written_ = std::chrono::steady_clock::now();
};

}  // namespace palpate::apps
