// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "shared/aliases.h"

namespace palpate::apps {

/// Ending of the record of a project: that of project.yaml is project.run.
constexpr const char* kProjectRecordEnding = ".run";

/// The content of files, by their paths.
using Fingerprints = std::map<std::string, std::string>;

/// The progress of a step.
enum class StepState {
  begun,   ///< or killed, if it is not running
  failed,  ///< or interrupted: its outputs are known
  done,
};

/// The record of `palpate run` of a step that it has done, or has begun.
// NOLINTNEXTLINE(bugprone-exception-escape): JSON is moved without throwing.
struct StepRecord {
  StepState state = StepState::begun;
  std::string version = {};              ///< of palpate
  nlohmann::json entries = {};           ///< as in `StepCall`
  Fingerprints inputs = {};              ///< before it began
  std::vector<std::string> writes = {};  ///< the files and folders that it should write
  Fingerprints outputs = {};             ///< written files; empty while it runs
  int shards = 0;                        ///< number of shards of its work; 0: not divided
  std::vector<std::string> jobs = {};    ///< of Slurm, to which its shards were submitted
  double seconds = 0;
  Json figures = Json::object();
};

/// The record of `palpate run` of all steps of a project: a JSON file beside its results.
class ProjectRecord {
 public:
  /// Reads the file if it is there.
  /// \throws FileError if it is not such a record.
  explicit ProjectRecord(fs::path file);

  /// Returns null if the step was never begun.
  [[nodiscard]] const StepRecord* find(const std::string& step) const;

  /// Replaces the record of a step, and writes the file.
  /// \throws OutputError if it cannot be written.
  void put(const std::string& step, StepRecord record);

  [[nodiscard]] const std::map<std::string, StepRecord>& steps() const { return steps_; }

 private:
  fs::path file_;
  std::map<std::string, StepRecord> steps_;
};

}  // namespace palpate::apps
