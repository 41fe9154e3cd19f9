// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "shared/aliases.h"

namespace palpate::apps {

/// An entry that a step has if its section does not give it: what an earlier step makes.
struct Feed {
  struct Source {
    std::string step, entry;  ///< the entry, or the `Beside`, of that step which names the file
    std::string file = {};    ///< in that folder
  };
  std::string entry;
  std::vector<Source> sources;      ///< the first whose step the project has
  std::vector<std::string> unless;  ///< entries in place of it
};

/// A folder that a command writes beside its main output, without an option for its name.
struct Beside {
  std::string name;
  std::string needs;  ///< the entry without which it is not written
};

/// A step of a project: a section of its file, and a command of the program.
struct ProjectStep {
  std::string name;                  ///< of the section
  std::vector<std::string> command;  ///< "probe", "plan"
  /// Entries whose values are files or folders that the command reads, and that it writes. All
  /// others are values.
  std::vector<std::string> inputs, outputs;
  std::string result_entry = "output";  ///< the entry of the main output; empty: there is none
  std::string result = {};              ///< its usual name
  /// Entries of which one gives the main output its ending; it then has the name of the input.
  std::vector<std::string> formats = {};
  std::vector<Feed> feeds = {};
  std::vector<Beside> beside = {};
  /// The command does its options in the order in which they are given; usually their order does
  /// not count.
  bool ordered = false;
  /// The entry that names the items which --shard divides; empty: the work cannot be divided.
  std::string items = {};
  /// The output holds measurements, which are never replaced; 'probe resume' goes on with them.
  bool measures = false;
  /// The figure to print of what the command says with --json.
  std::string (*main_figure)(const Json& figures) = nullptr;
};

/// All steps, in the order in which they are done.
[[nodiscard]] std::span<const ProjectStep> project_steps();

/// The command that these words name among those of the program.
[[nodiscard]] CLI::App* command_of(const std::vector<std::string>& words, CLI::App& program);

/// The names that a section of this command may have: its long options and, in small letters, its
/// arguments. Without those that `palpate run` gives itself.
[[nodiscard]] std::vector<std::string> entry_names(const CLI::App& command);

/// The option or argument of an entry; null if the command has none of that name.
[[nodiscard]] const CLI::Option* option_of(const CLI::App& command, const std::string& entry);

}  // namespace palpate::apps
