// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// Extension in lower case, with the dot.
[[nodiscard]] std::string lower_extension(const std::filesystem::path& path);

/// Returns true if the name begins with a dot. Readers of folders skip such files: the temporary
/// files of `output_file.h`, and files that other systems add, such as ._000000.tiff.
[[nodiscard]] bool is_hidden(const std::filesystem::path& path);

/// Returns true if the name of `a` (without its folder) sorts before that of `b`: character by
/// character, with digits compared as numbers, so that 2.png comes before 10.png.
[[nodiscard]] bool comes_before(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace palpate
