// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/aliases.h"

namespace palpate::apps {

/// An entry of a section: an option or an argument of the section's command.
struct ProjectEntry {
  std::string name;
  int line = 0;
  /// Each time that the option is given, and its values: "a" is {{"a"}}, [a, b] is {{"a", "b"}},
  /// [[a, b], [c, d]] is {{"a", "b"}, {"c", "d"}}. No value is empty.
  std::vector<std::vector<std::string>> values;
};

/// A section of a project: a command that is called once.
struct ProjectSection {
  std::string name;
  int line = 0;
  std::vector<ProjectEntry> entries;
};

/// The content of a project file (docs/projects.md), as it is written there. Names and values are
/// not checked.
struct Project {
  fs::path output;  ///< folder for the results; empty: that of the file
  std::vector<ProjectSection> sections;
};

/// Reads a project file (YAML).
/// \throws FileError with the line if the file is not YAML, or not sections with entries.
[[nodiscard]] Project read_project(const fs::path& path);

/// Refuses the content of a line of a project: "project.yaml: line 3: `what`".
[[noreturn]] void refuse_in_project(const fs::path& path, int line, const std::string& what);

}  // namespace palpate::apps
