// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/file_names.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <vector>

namespace palpate {
namespace {

using Paths = std::vector<std::filesystem::path>;

TEST(FileNames, AreOrderedByTheNumbersInThem) {
  const Paths ordered = {"1.png",
                         "02.png",
                         "9.png",
                         "10.png",
                         "010_b.png",
                         "frame.png",
                         "frame1_9.png",
                         "frame1_10.png",
                         "frame02.png",
                         "frame2.png",
                         "frame2_01.png",
                         "frame10.png",
                         "frame99999999999999999999998.png",
                         "frame99999999999999999999999.png"};
  for (std::size_t i = 0; i < ordered.size(); ++i) {
    for (std::size_t j = 0; j < ordered.size(); ++j) {
      EXPECT_EQ(comes_before(ordered[i], ordered[j]), i < j) << ordered[i] << ' ' << ordered[j];
    }
  }
}

TEST(FileNames, AreOrderedWhateverFolderTheyLieIn) {
  EXPECT_TRUE(comes_before("b/2.png", "a/10.png"));
  EXPECT_FALSE(comes_before("a/10.png", "b/2.png"));
}

TEST(FileNames, AreHiddenIfTheyBeginWithADot) {
  EXPECT_TRUE(is_hidden("range/.palpate-tmp-host-1-2-a.tiff"));
  EXPECT_TRUE(is_hidden("._000000.tiff"));
  EXPECT_FALSE(is_hidden(".folder/000000.tiff"));
}

TEST(FileNames, HaveTheirExtensionInLowerCase) {
  EXPECT_EQ(lower_extension("folder.X/Frame.TiFF"), ".tiff");
  EXPECT_EQ(lower_extension("folder.X/frame"), "");
}

}  // namespace
}  // namespace palpate
