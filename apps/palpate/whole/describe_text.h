// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "surfaces/describe_mesh.h"

namespace palpate::apps {

/// Describes a file of settings (YAML): rig, camera, pattern, trained colours, response, sensor,
/// project.
/// \throws FileError if it is not one of these, or damaged.
[[nodiscard]] Description describe_yaml(const fs::path& path);

/// Describes a table (CSV) by its header.
/// \throws FileError if it cannot be read.
[[nodiscard]] Description describe_csv(const fs::path& path);

/// Describes a record (JSON Lines) of `palpate decode`, or of `palpate capture`.
/// \throws FileError if it is not such a record.
[[nodiscard]] Description describe_record(const fs::path& path);

/// Describes the record that `palpate run` keeps beside the results of a project.
/// \throws FileError if it is not such a record.
[[nodiscard]] Description describe_project_record(const fs::path& path);

}  // namespace palpate::apps
