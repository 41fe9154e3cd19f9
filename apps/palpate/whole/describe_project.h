// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surfaces/describe_mesh.h"

namespace palpate::apps {

/// Whether the text of a YAML file has a section of a project.
[[nodiscard]] bool is_project(const std::string& text);

/// Describes a project file.
/// \throws FileError if it is damaged.
[[nodiscard]] Description describe_project(const fs::path& path);

/// Describes the record that `palpate run` keeps beside the results of a project.
/// \throws FileError if it is none.
[[nodiscard]] Description describe_project_record(const fs::path& path);

}  // namespace palpate::apps
