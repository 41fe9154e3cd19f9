// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/png_check.h"

#include <gtest/gtest.h>

#include "test_files.h"

namespace palpate::sensing {
namespace {

TEST(PngCheck, FindsNothingInWholeFiles) {
  EXPECT_EQ(find_png_damage(read_text(demo_path("frames/duck.png"))), "");
  EXPECT_EQ(find_png_damage(read_text(demo_path("truth/duck_id.png"))), "");
}

TEST(PngCheck, FindsTruncationAndChangedBytes) {
  const std::string whole = read_text(demo_path("truth/duck_lit.png"));
  for (std::size_t length = 0; length < whole.size(); length += 101) {
    EXPECT_NE(find_png_damage(whole.substr(0, length)), "") << length;
  }
  EXPECT_NE(find_png_damage(whole.substr(0, whole.size() - 1)), "");
  for (std::size_t place = 0; place < whole.size(); place += 53) {
    std::string damaged = whole;
    damaged[place] = static_cast<char>(damaged[place] ^ 4);
    EXPECT_NE(find_png_damage(damaged), "") << place;
  }
}

TEST(PngCheck, AChunkLongerThanAnyFileIsTruncation) {
  std::string huge = read_text(demo_path("truth/duck_lit.png"));
  for (std::size_t i = 8; i < 12; ++i) huge[i] = '\xFF';
  EXPECT_NE(find_png_damage(huge).find("truncated"), std::string::npos);
}

}  // namespace
}  // namespace palpate::sensing
