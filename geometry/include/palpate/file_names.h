// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// The extension in lower case, with its dot.
[[nodiscard]] std::string lower_extension(const std::filesystem::path& path);

/// Whether the name (without its folder) of `a` comes before that of `b`: character by character,
/// but digits count as the numbers they write, so that 2.png comes before 10.png.
[[nodiscard]] bool comes_before(const std::filesystem::path& a, const std::filesystem::path& b);

}  // namespace palpate
