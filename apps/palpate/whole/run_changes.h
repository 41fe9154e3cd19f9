// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>
#include "shared/aliases.h"

namespace palpate::apps {

/// The content of files, by their paths.
using Fingerprints = std::map<std::string, std::string>;

/// How far a step is.
enum class StepState {
  begun,   ///< and killed, if it is not at work
  failed,  ///< or interrupted: what it has written is known
  done,
};

/// What `palpate run` knows of a step that it has done, or has begun.
// NOLINTNEXTLINE(bugprone-exception-escape): JSON is moved without throwing.
struct StepRecord {
  StepState state = StepState::begun;
  std::string version = {};              ///< of palpate
  nlohmann::json entries = {};           ///< as in `StepCall`
  Fingerprints inputs = {};              ///< before it began
  std::vector<std::string> writes = {};  ///< the files and folders that it was to write
  Fingerprints outputs = {};             ///< what it has written; empty while it is at work
  double seconds = 0;
  Json figures = Json::object();
};

/// Texts as they come back from a JSON file, which is UTF-8; names of files need not be.
[[nodiscard]] nlohmann::json in_utf8(const nlohmann::json& texts);

/// Reads files, and all files in folders. Hidden files and records (.jsonl), which hold times, do
/// not count. Beside a range map, what its command reads too: the rig, and the files that `palpate
/// decode` writes for the same frame. Paths that do not exist are left out.
[[nodiscard]] Fingerprints fingerprints_of(const std::vector<fs::path>& paths);

/// Why a step is to be done that was done, or begun, before: in words, the most important first;
/// empty if nothing has changed.
/// \param now what it would be done with.
/// \param there its outputs that exist.
[[nodiscard]] std::vector<std::string> changes_since(const StepRecord& before,
                                                     const StepRecord& now,
                                                     const Fingerprints& there);

/// Whether nothing has changed since a step began that is not done.
[[nodiscard]] bool can_be_resumed(const StepRecord& before, const StepRecord& now);

/// Checks that all files where a step would write are as `palpate run` has left them.
/// \param before null if the step was never begun.
/// \throws InvalidInput that names the first that is not, and what to do.
void check_own(const std::string& step, const StepRecord* before, const Fingerprints& there);

}  // namespace palpate::apps
