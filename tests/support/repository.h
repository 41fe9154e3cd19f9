// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

namespace palpate {

/// A file of the repository, by its path from the root.
[[nodiscard]] std::filesystem::path repository(const std::filesystem::path& path);

}  // namespace palpate
