// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "shared/aliases.h"

namespace palpate::apps {

/// The finished items of a long run, so that --resume can continue it.
///
/// The file holds JSON Lines: the first line is the head, with all that the results depend on; each
/// further line is one finished item.
// NOLINTNEXTLINE(bugprone-exception-escape): JSON is moved without throwing.
struct RunRecord {
  Json head;
  std::vector<Json> items;
};

/// Reads a record. A last line without a line break was cut off by a crash and does not count.
/// \param remedy for the message: how the user can continue without the record.
/// \throws FileError if there is no whole head, or a line is not JSON.
[[nodiscard]] RunRecord read_run_record(const fs::path& file, const std::string& remedy);

/// Checks that a run continues with the settings with which it began.
/// \param before the settings in the head of the record `file`.
/// \param now those of this call, by the names of the options.
/// \throws InvalidInput that names the first option that differs, and both values.
void check_same_settings(const fs::path& file, const Json& before, const Json& now,
                         const std::string& remedy);

/// Writes a record. Each item is appended once, so the bytes written grow linearly with the items.
class RunRecordWriter {
 public:
  /// Replaces `file` as a whole by `start`; items are appended to it.
  /// \throws OutputError if the file cannot be written.
  RunRecordWriter(fs::path file, const RunRecord& start);

  /// Appends one line and passes it to the operating system: it survives a crash of this process.
  /// \throws OutputError if the disk is full.
  void add(const Json& item);

 private:
  fs::path file_;
  std::ofstream stream_;
};

}  // namespace palpate::apps
