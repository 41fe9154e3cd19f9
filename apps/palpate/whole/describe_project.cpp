// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/describe_project.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <vector>

#include "shared/project_file.h"
#include "whole/project_record.h"
#include "whole/run_steps.h"

namespace palpate::apps {

bool is_project(const std::string& text) {
  return std::ranges::any_of(project_steps(), [&](const ProjectStep& step) {
    return text.starts_with(step.name + ":") || text.find("\n" + step.name + ":") != text.npos;
  });
}

Description describe_project(const fs::path& path) {
  std::vector<std::string> names;
  for (const ProjectSection& section : read_project(path).sections) names.push_back(section.name);
  return {{{"kind", "project"}, {"steps", names}},
          fmt::format("project of {} steps: {}; 'palpate run --dry-run' says which are to be done",
                      names.size(), fmt::join(names, ", "))};
}

Description describe_project_record(const fs::path& path) {
  std::vector<std::string> done, begun;
  const ProjectRecord record(path);
  for (const auto& [name, step] : record.steps())
    (step.state == StepState::done ? done : begun).push_back(name);
  std::string prose = fmt::format("record of palpate run; done: {}", fmt::join(done, ", "));
  if (!begun.empty()) prose += fmt::format("; begun: {}", fmt::join(begun, ", "));
  return {{{"kind", "record of run"}, {"steps", done}}, prose};
}

}  // namespace palpate::apps
