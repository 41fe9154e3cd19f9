// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace palpate {

/// Returns 16 hexadecimal digits (FNV-1a) that almost certainly differ if the content of two files
/// differs, but do not protect against forgery; those of an empty file if it cannot be read.
[[nodiscard]] std::string file_fingerprint(const std::filesystem::path& file);

/// Returns the fingerprint of a file with this content.
[[nodiscard]] std::string text_fingerprint(std::string_view text);

}  // namespace palpate
