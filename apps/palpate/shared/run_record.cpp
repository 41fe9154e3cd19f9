// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/run_record.h"

#include <fmt/format.h>

#include <ostream>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"

namespace palpate::apps {
namespace {

/// One line. File names need not be UTF-8, but JSON must be.
std::string to_line(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace

RunRecord read_run_record(const fs::path& file, const std::string& remedy) {
  RunRecord record;
  std::ifstream stream(file, std::ios::binary);
  int number = 0;
  const auto refusal = [&](const std::string& reason) {
    return FileError(fmt::format("{}: line {}: {}; this is not the record of an earlier run. {}.",
                                 file.string(), number, reason, remedy));
  };
  for (std::string line; ++number, std::getline(stream, line) && !stream.eof();) {
    Json json = Json::parse(line, nullptr, false);
    if (json.is_discarded()) throw refusal("is not JSON");
    if (number == 1)
      record.head = std::move(json);
    else
      record.items.push_back(std::move(json));
  }
  if (record.head.is_null()) throw refusal("is missing or incomplete");
  return record;
}

void check_same_settings(const fs::path& file, const Json& before, const Json& now,
                         const std::string& remedy) {
  for (const auto& [name, value] : now.items()) {
    const Json earlier = before.is_object() ? before.value(name, Json()) : Json();
    if (earlier == value) continue;
    throw InvalidInput(fmt::format(
        "{}: the earlier run had another {}: {} then, {} now. {}, or pass the same value.",
        file.string(), name, earlier.dump(), value.dump(), remedy));
  }
}

RunRecordWriter::RunRecordWriter(fs::path file, const RunRecord& start) : file_(std::move(file)) {
  write_file(file_, [&](std::ostream& out) {
    out << to_line(start.head);
    for (const Json& item : start.items) out << to_line(item);
  });
  stream_.open(file_, std::ios::binary | std::ios::app);
  if (!stream_) throw OutputError(file_.string() + ": cannot be written; check its permissions.");
}

void RunRecordWriter::add(const Json& item) {
  stream_ << to_line(item) << std::flush;
  if (!stream_) throw OutputError(file_.string() + ": cannot be written; the disk may be full.");
}

}  // namespace palpate::apps
