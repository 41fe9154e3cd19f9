// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "records/file_kind.h"

#include <algorithm>
#include <array>

namespace palpate::probing {
namespace {

using std::string_view_literals::operator""sv;

struct FileKind {
  std::string_view start, words;
};

constexpr std::array<FileKind, 9> kFileKinds = {{
    {"PK\3\4"sv,
     "a workbook (.xlsx, .ods) or a zip archive; save the sheet as CSV, or unpack the file"},
    {"\xD0\xCF\x11\xE0"sv, "an old workbook (.xls); save the sheet as CSV"},
    {"\x1F\x8B"sv, "compressed (gzip); unpack it"},
    {"\xFF\xFE"sv, "text in UTF-16; save it as UTF-8"},
    {"\xFE\xFF"sv, "text in UTF-16; save it as UTF-8"},
    {"\x89HDF"sv,
     "an HDF5 file; export its table as CSV (MATLAB: save with -v7, and name it .mat)"},
    {"MATLAB 5.0 MAT-file"sv, "a MAT file; give it the extension .mat"},
    {"SQLite format 3"sv, "an SQLite database; palpate fit reads those of Palpate as they are"},
    {"#ROSBAG"sv, "a rosbag; write its messages to a CSV file, one row each"},
}};

}  // namespace

std::optional<std::string_view> other_than_text(std::string_view start) {
  const auto known = std::find_if(kFileKinds.begin(), kFileKinds.end(), [&](const FileKind& kind) {
    return start.starts_with(kind.start);
  });
  if (known != kFileKinds.end()) return known->words;
  if (start.find('\0') != std::string_view::npos) return "no text file; expected a CSV file";
  if (start.find('\n') == std::string_view::npos) {
    const std::size_t end = start.find('\r');
    if (end != std::string_view::npos && end + 1 < start.size())
      return "text whose lines end with carriage returns alone; save it with line feeds (\\n)";
  }
  return std::nullopt;
}

}  // namespace palpate::probing
