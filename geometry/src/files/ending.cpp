// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/ending.h"

#include <algorithm>
#include <array>

#include "files/file_formats.h"
#include "palpate/core/input_file.h"

namespace palpate::geometry {
namespace {

/// First words of lines of OBJ files.
constexpr std::array<std::string_view, 9> kObjWords = {"v", "vn", "vt",     "f",     "o",
                                                       "g", "s",  "usemtl", "mtllib"};

/// The first word that is not in a comment.
std::string_view first_word(std::string_view content) {
  while (!content.empty()) {
    std::string_view line = next_line(content);
    const std::string_view word = next_word(line);
    if (!word.empty() && !word.starts_with('#')) return word;
  }
  return "";
}

}  // namespace

std::string ending_by_content(std::string_view content) {
  if (content.starts_with("ply\n") || content.starts_with("ply\r")) return ".ply";
  if (content.starts_with("glTF")) return ".glb";
  if (is_binary_stl(content)) return ".stl";
  const std::string_view word = first_word(content);
  if (word == "solid") return ".stl";
  if (word == "VERSION" || word == "FIELDS") return ".pcd";
  if (word.ends_with("OFF")) return ".off";
  return std::ranges::find(kObjWords, word) != kObjWords.end() ? ".obj" : "";
}

}  // namespace palpate::geometry
