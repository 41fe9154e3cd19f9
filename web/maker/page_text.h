// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>

namespace palpate::web {

/// The text of a template of pages, as this folder makes them.
/// \throws FileError if it is not there.
[[nodiscard]] std::string page_template(const std::filesystem::path& path);

/// Replaces a mark of a template, wherever it is.
/// \throws FileError if it is nowhere.
void fill(std::string& page, const std::string& mark, const std::string& text);

/// Bytes as a page holds them: gzip, in base64.
[[nodiscard]] std::string packed_text(std::span<const std::byte> bytes);

}  // namespace palpate::web
