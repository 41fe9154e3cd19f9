// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>

#include "whole/run_changes.h"

namespace palpate::apps {

/// Ending of the record of a project: that of project.yaml is project.run.
constexpr const char* kProjectRecordEnding = ".run";

/// What `palpate run` knows of all steps of a project: a JSON file beside its results.
class ProjectRecord {
 public:
  /// Reads the file if it is there.
  /// \throws FileError if it is not such a record.
  explicit ProjectRecord(fs::path file);

  /// Null if the step was never begun.
  [[nodiscard]] const StepRecord* find(const std::string& step) const;

  /// Replaces what is known of a step, and writes the file.
  /// \throws OutputError if it cannot be written.
  void put(const std::string& step, StepRecord record);

  [[nodiscard]] const std::map<std::string, StepRecord>& steps() const { return steps_; }

 private:
  fs::path file_;
  std::map<std::string, StepRecord> steps_;
};

}  // namespace palpate::apps
