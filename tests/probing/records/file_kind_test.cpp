// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "records/file_kind.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace palpate::probing {
namespace {

using std::string_literals::operator""s;

TEST(FileKind, IsKnownByTheFirstBytes) {
  const std::vector<std::pair<std::string, std::string>> kinds = {
      {"PK\3\4\24\0\6\0"s, "save the sheet as CSV"},
      {"\xD0\xCF\x11\xE0\xA1\xB1"s, "(.xls)"},
      {"\x1F\x8B\x08\0"s, "unpack it"},
      {"\xFF\xFEi\0d\0"s, "save it as UTF-8"},
      {"\xFE\xFF\0i\0d"s, "save it as UTF-8"},
      {"\x89HDF\r\n\x1A\n"s, "HDF5"},
      {"MATLAB 5.0 MAT-file, Platform"s, "extension .mat"},
      {"SQLite format 3\0"s, "SQLite"},
      {"#ROSBAG V2.0\n"s, "one row each"},
      {"id,x\n1,\0\n"s, "no text file"},
      {"id,x\r1,2\r"s, "line feeds"}};
  for (const auto& [start, words] : kinds) {
    const auto found = other_than_text(start);
    ASSERT_TRUE(found) << words;
    EXPECT_NE(found->find(words), std::string_view::npos) << *found;
  }
}

TEST(FileKind, OfTextIsText) {
  for (const std::string& start : std::vector<std::string>{
           "", "id,x\n1,2\n", "id,x\r\n1,2\r\n", "\xEF\xBB\xBFid,x\n", "PK,x\n1,2\n", "id,x\r"})
    EXPECT_FALSE(other_than_text(start)) << start;
}

}  // namespace
}  // namespace palpate::probing
