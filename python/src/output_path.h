// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <system_error>

#include "palpate/core/error.h"

namespace palpate::python {

/// The path of a file or folder to write. The library would make missing folders above it; here a
/// mistyped one is refused.
/// \throws OutputError naming the folder.
[[nodiscard]] inline const std::filesystem::path& output_path(const std::filesystem::path& path) {
  const std::filesystem::path place = path.has_filename() ? path : path.parent_path();
  const std::filesystem::path folder = place.parent_path();
  std::error_code unknown;  // writing will tell more
  if (folder.empty() || std::filesystem::is_directory(folder, unknown)) return path;
  throw OutputError(path.string() + ": there is no folder " + folder.string() +
                    "; check the path, or make the folder first");
}

}  // namespace palpate::python
