// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace palpate {

/// Returns the whole content of a file, or everything that a pipe sends until it is closed.
/// \throws FileError if it is missing, neither a regular file nor a pipe, empty or unreadable.
[[nodiscard]] std::string read_input_file(const std::filesystem::path& path);

/// \throws FileError naming `file` if `needed` bytes exceed the limit (`memory_limit.h`).
void check_memory_to_read(double needed, double file_size, const std::string& file);

/// Line number, from 1, of the character at `offset`.
[[nodiscard]] std::size_t line_number(std::string_view content, std::size_t offset);

/// Removes the first blank-separated word from `rest` and returns it; empty at the end.
[[nodiscard]] std::string_view next_word(std::string_view& rest);

/// Removes the first line from `rest` and returns it without its end (\n or \r\n).
[[nodiscard]] std::string_view next_line(std::string_view& rest);

/// Quotes a piece of a file for a message, truncated if it is long.
[[nodiscard]] std::string quoted(std::string_view text);

/// Parses a word as a number; nullopt if it contains anything else or is out of range.
template <typename Number>
[[nodiscard]] std::optional<Number> parse_number(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  Number number{};
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return number;
}

}  // namespace palpate
