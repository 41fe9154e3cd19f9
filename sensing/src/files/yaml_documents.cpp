// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/yaml_documents.h"

#include <algorithm>
#include <cctype>

namespace palpate::sensing {
namespace {

/// The brackets that a line opens less those it closes, without those in quotes and comments; the
/// lowest value on the way is below -`open` if one of them closes nothing.
struct Brackets {
  int change = 0;
  int lowest = 0;
};

Brackets brackets_of(std::string_view line) {
  Brackets brackets;
  char quote = 0;      // that has begun
  bool starts = true;  // a value, which alone may begin with a quote
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (quote != 0) {
      if (quote == '"' && c == '\\') ++i;
      if (c == quote) quote = 0;
      continue;
    }
    if (c == '#') break;
    if ((c == '"' || c == '\'') && starts) quote = c;
    if (c == '[' || c == '{') ++brackets.change;
    if (c == ']' || c == '}') brackets.lowest = std::min(brackets.lowest, --brackets.change);
    if (std::isspace(static_cast<unsigned char>(c)) == 0) {
      starts = std::string_view(":,-[{").find(c) != std::string_view::npos;
    }
  }
  return brackets;
}

bool is_blank(std::string_view line) {
  const std::size_t first = line.find_first_not_of(" \t\r");
  return first == std::string_view::npos || line[first] == '#';
}

}  // namespace

std::optional<std::size_t> second_yaml_document(std::string_view text) {
  if (!text.starts_with("%YAML")) return std::nullopt;
  int open = 0;            // brackets
  bool begun = false;      // the document
  bool ended = false;      // by a line of `...`
  std::size_t number = 0;  // of the line
  for (std::size_t at = 0; at < text.size(); ++number) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line = text.substr(at, end - at);
    at = end + 1;
    if (is_blank(line) || line.starts_with('%')) continue;
    if (ended || (begun && line.starts_with("---"))) return number + 1;
    begun = true;
    ended = line.starts_with("...");
    const Brackets brackets = brackets_of(line);
    if (open + brackets.lowest < 0) return number + 1;
    open += brackets.change;
  }
  return std::nullopt;
}

}  // namespace palpate::sensing
