// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <optional>

#include "palpate/haptics/force_field_fit.h"
#include "shared/run_record.h"

namespace palpate::apps {

/// Records which contacts are fitted, for --resume, in a `RunRecord` beside the model.
class FitRecord {
 public:
  /// \param settings all options and data on which the fits depend, by name.
  FitRecord(fs::path file, Json settings);

  /// Takes over the fits that an earlier run has finished, if there was one.
  /// \throws InvalidInput if that run had other settings.
  /// \throws FileError if its record cannot be read.
  void resume();

  /// Checks that the record may be written, before the fits are computed. The record of an earlier
  /// run is replaced unless it was resumed.
  /// \throws InvalidInput if the file exists and is not such a record.
  void begin() const;

  /// Appends a fit. The first call creates the file.
  /// \throws OutputError if it cannot be written.
  void add(long long contact, const haptics::FitResult& fit);

  /// The fit of a contact that an earlier run has finished, or null.
  [[nodiscard]] const haptics::FitResult* find(long long contact) const;
  [[nodiscard]] std::size_t size() const { return fits_.size(); }

  /// Removes the record, after the model is written.
  void remove();

 private:
  void check_same(const Json& head) const;

  fs::path file_;
  Json settings_;
  std::map<long long, haptics::FitResult> fits_;  ///< of the earlier run
  bool resumed_ = false;
  std::optional<RunRecordWriter> writer_;  ///< after the first `add`
};

}  // namespace palpate::apps
