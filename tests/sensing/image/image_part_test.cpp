// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "image/image_part.h"

#include <gtest/gtest.h>

#include <random>

namespace palpate::sensing {
namespace {

bool operator==(const ImagePart& a, const ImagePart& b) {
  return a.row == b.row && a.column == b.column && a.rows == b.rows && a.columns == b.columns;
}

bool contains(const ImagePart& part, long row, long column) {
  return row >= part.row && row < part.row + part.rows && column >= part.column &&
         column < part.column + part.columns;
}

TEST(LitPart, ContainsWhatIsLitWithItsMargin) {
  std::mt19937 random(3);
  const auto any = [&](long below) {
    return std::uniform_int_distribution<long>(0, below - 1)(random);
  };
  for (int i = 0; i < 200; ++i) {
    Mask lit = Mask::Zero(20 + any(200), 20 + any(200));
    const long row = any(lit.rows() - 10), column = any(lit.cols() - 10), margin = any(30);
    lit.block(row, column, 10, 10) = 1;
    const ImagePart part = lit_part(lit, margin);
    EXPECT_TRUE(contains(part, std::max(0L, row - margin), std::max(0L, column - margin)));
    EXPECT_TRUE(contains(part, std::min(lit.rows() - 1, row + 9 + margin),
                         std::min(lit.cols() - 1, column + 9 + margin)));
    EXPECT_TRUE(contains({0, 0, lit.rows(), lit.cols()}, part.row, part.column));
    EXPECT_LE(part.row + part.rows, lit.rows());
    EXPECT_LE(part.column + part.columns, lit.cols());
    EXPECT_EQ(part.row % kPartSpacing, 0);
    EXPECT_EQ(part.column % kPartSpacing, 0);
  }
}

TEST(LitPart, IsNotMuchLargerThanWhatIsLit) {
  Mask lit = Mask::Zero(480, 640);
  lit.block(100, 200, 150, 120) = 1;
  const ImagePart part = lit_part(lit, 10);
  EXPECT_LE(part.rows, 150 + 2 * 10 + 2 * kPartSpacing);
  EXPECT_LE(part.columns, 120 + 2 * 10 + 2 * kPartSpacing);
}

TEST(LitPart, HardlyGrowsForSinglePixels) {
  Mask lit = Mask::Zero(480, 640);
  lit.block(100, 200, 150, 120) = 1;
  const ImagePart part = lit_part(lit, 10);
  std::mt19937 random(5);
  for (int i = 0; i < 300; ++i) lit.data()[random() % static_cast<unsigned long>(lit.size())] = 1;
  const ImagePart with_noise = lit_part(lit, 10);
  EXPECT_LE(with_noise.rows, part.rows + 2 * kPartSpacing);
  EXPECT_LE(with_noise.columns, part.columns + 2 * kPartSpacing);
}

TEST(LitPart, IsTheWholeImageIfThatIsHardlyLarger) {
  Mask lit = Mask::Ones(100, 90);
  EXPECT_TRUE(lit_part(lit, 0).is_whole(lit));
  lit.leftCols(3) = 0;
  EXPECT_TRUE(lit_part(lit, 0).is_whole(lit));
}

TEST(LitPart, IsOneBlockInTheDark) {
  EXPECT_TRUE(lit_part(Mask::Zero(100, 90), 20) == (ImagePart{0, 0, 16, 16}));
  EXPECT_TRUE(lit_part(Mask::Zero(7, 90), 20) == (ImagePart{0, 0, 7, 16}));
}

}  // namespace
}  // namespace palpate::sensing
