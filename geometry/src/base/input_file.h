// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace palpate::geometry {

/// The whole content of a file.
/// \throws FileError if it is missing, not a regular file, empty or unreadable.
[[nodiscard]] std::string read_input_file(const std::filesystem::path& path);

/// Line of the character at `offset`, from 1.
[[nodiscard]] std::size_t line_number(std::string_view content, std::size_t offset);

/// Takes the first word (what stands between blanks) off `rest`; empty at the end.
[[nodiscard]] std::string_view next_word(std::string_view& rest);

/// Takes the first line off `rest`, without its end (\n or \r\n).
[[nodiscard]] std::string_view next_line(std::string_view& rest);

/// A piece of a file in quotes for a message, cut off where it gets long.
[[nodiscard]] std::string quoted(std::string_view text);

/// The number that `word` is, and nothing but; nullopt if it is something else or out of range.
template <typename Number>
[[nodiscard]] std::optional<Number> parse_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

}  // namespace palpate::geometry
