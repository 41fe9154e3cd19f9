// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>

#include "palpate/haptics/force_field_fit.h"

namespace palpate::apps {

/// The fits of contacts that are finished, in a file beside the model that they are for: what they
/// depend on, then one line a contact, written at once. A kill may cut the last line, which then
/// does not count.
class FitRecord {
 public:
  /// `settings`: by name, all that the fits depend on.
  FitRecord(std::filesystem::path file, nlohmann::ordered_json settings);

  /// Takes over what an earlier run finished; without one there is nothing to take over.
  /// \throws InvalidInput unless its settings are the same; FileError if its record cannot be read.
  void resume();

  /// Before there is much work. Unless resumed, the record of an earlier run is to be replaced.
  /// \throws InvalidInput if there is a file that is no such record.
  void begin() const;

  /// The first one makes the file.
  /// \throws OutputError.
  void add(long long contact, const haptics::FitResult& fit);

  /// Null if it is not finished.
  [[nodiscard]] const haptics::FitResult* find(long long contact) const;
  [[nodiscard]] std::size_t size() const { return fits_.size(); }

  /// The model is written: nothing is left to resume.
  void remove();

 private:
  void check_same(const nlohmann::ordered_json& head) const;
  void open();

  std::filesystem::path file_;
  nlohmann::ordered_json settings_;
  std::map<long long, haptics::FitResult> fits_;  ///< of the earlier run
  bool resumed_ = false;
  std::uintmax_t whole_bytes_ = 0;  ///< of the earlier run's file, without a line that was cut
  std::ofstream stream_;
};

}  // namespace palpate::apps
