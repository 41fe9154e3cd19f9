// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/input_file.h"

#include <algorithm>
#include <fstream>
#include <iterator>

#include "palpate/core/error.h"
#include "palpate/core/memory_limit.h"

namespace palpate {

namespace fs = std::filesystem;

namespace {

// Not find_first_of, which would search a string of blanks for each character.
constexpr bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

std::string read_pipe(const fs::path& path) {
  std::ifstream stream(path, std::ios::binary);
  if (!stream) throw FileError(path.string() + ": cannot be opened for reading");
  std::string content(std::istreambuf_iterator<char>(stream), {});
  if (stream.bad()) throw FileError(path.string() + ": cannot be read to its end");
  if (content.empty()) throw FileError(path.string() + ": is a pipe through which nothing came");
  return content;
}

}  // namespace

std::string read_input_file(const fs::path& path) {
  std::error_code error;
  if (fs::is_directory(path, error))
    throw FileError(path.string() + ": is a folder; expected a file");
  const fs::file_status status = fs::status(path, error);
  if (!fs::exists(status)) throw FileError(path.string() + ": no such file");
  if (fs::is_fifo(status) || fs::is_socket(status)) return read_pipe(path);
  if (!fs::is_regular_file(status))
    throw FileError(path.string() + ": is neither a file nor a pipe");
  const std::uintmax_t size = fs::file_size(path, error);
  std::ifstream stream(path, std::ios::binary);
  if (error || !stream) throw FileError(path.string() + ": cannot be opened for reading");
  if (size == 0) throw FileError(path.string() + ": is empty");
  std::string content(size, '\0');
  stream.read(content.data(), static_cast<std::streamsize>(size));
  if (!stream) throw FileError(path.string() + ": cannot be read to its end");
  return content;
}

void check_memory_to_read(double needed, double file_size, const std::string& file) {
  if (const auto wrong = beyond_memory_limit(needed, file_size))
    throw FileError(file + ": " + *wrong);
}

std::size_t line_number(std::string_view content, std::size_t offset) {
  const std::string_view before = content.substr(0, offset);
  return 1 + static_cast<std::size_t>(std::count(before.begin(), before.end(), '\n'));
}

std::string_view next_word(std::string_view& rest) {
  rest.remove_prefix(static_cast<std::size_t>(std::find_if_not(rest.begin(), rest.end(), is_blank) -
                                              rest.begin()));
  const std::string_view word = rest.substr(
      0, static_cast<std::size_t>(std::find_if(rest.begin(), rest.end(), is_blank) - rest.begin()));
  rest.remove_prefix(word.size());
  return word;
}

std::string_view next_line(std::string_view& rest) {
  std::string_view line = rest.substr(0, rest.find('\n'));
  rest.remove_prefix(std::min(line.size() + 1, rest.size()));
  if (line.ends_with('\r')) line.remove_suffix(1);
  return line;
}

std::string quoted(std::string_view text) {
  constexpr std::size_t kLongest = 60;  // characters
  std::string result = "\"";
  result += text.substr(0, kLongest);
  result += text.size() > kLongest ? "...\"" : "\"";
  return result;
}

}  // namespace palpate
