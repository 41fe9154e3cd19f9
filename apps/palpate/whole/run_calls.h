// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "shared/project_file.h"
#include "whole/run_steps.h"

namespace palpate::apps {

/// The call of a command that is a step of a project. Paths are as the command gets them: relative
/// to the folder of the project.
// NOLINTNEXTLINE(bugprone-exception-escape): JSON is moved without throwing.
struct StepCall {
  const ProjectStep* step = nullptr;
  nlohmann::json entries = {};          ///< {"tolerance": [["0.2"]]}, with those that it is fed
  std::vector<std::string> words = {};  ///< "mesh", "range/000000.tiff", "--tolerance=0.2", ...
  /// The call that goes on where an interrupted one has ended; empty if there is none.
  std::vector<std::string> resuming_words = {};
  bool takes_shard = false;  ///< true if --shard goes with these words
  std::vector<fs::path> inputs = {}, outputs = {};
};

/// The calls of all sections of a project, in the order in which they are done. Each is checked as
/// far as that is possible without doing it: the names and values of its entries, that its inputs
/// exist or are made by an earlier step, and that no two steps write the same.
/// The current folder must be that of the project.
/// \param file for messages.
/// \param results folder for the results, relative to that of the project; empty if it is that.
/// \throws FileError that names the line, what is wrong in it and what would be right.
[[nodiscard]] std::vector<StepCall> calls_of(const fs::path& file, const Project& project,
                                             const fs::path& results);

/// Runs the program with these words, as if they had been typed.
/// \return the figures that it would print with --json.
/// \throws what the command throws.
Json run_call(const std::vector<std::string>& words);

/// Returns true if a path is `folder`, or lies in it.
[[nodiscard]] bool lies_in(const fs::path& path, const fs::path& folder);

}  // namespace palpate::apps
