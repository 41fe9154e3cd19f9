// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "latest_value.h"

#include <gtest/gtest.h>

#include <array>
#include <thread>

namespace palpate::view {
namespace {

/// A value that shows whether it was seen half written.
using Block = std::array<int, 64>;

Block block_of(int number) {
  Block block;
  block.fill(number);
  return block;
}

TEST(LatestValue, IsTheLastOneThatWasWritten) {
  LatestValue<int> value;
  EXPECT_EQ(value.read(), 0);
  value.write(1);
  value.write(2);
  EXPECT_EQ(value.read(), 2);
  EXPECT_EQ(value.read(), 2) << "it stays";
  value.write(3);
  EXPECT_EQ(value.read(), 3);
}

TEST(LatestValue, IsNeverSeenHalfWrittenNorOlderThanBefore) {
  LatestValue<Block> value;
  constexpr int kLast = 20'000;
  std::jthread writer([&] {
    for (int number = 1; number <= kLast; ++number) value.write(block_of(number));
  });
  int last = 0;
  while (last < kLast) {
    const Block& seen = value.read();
    ASSERT_GE(seen.front(), last);
    last = seen.front();
    ASSERT_EQ(seen, block_of(last));
  }
}

}  // namespace
}  // namespace palpate::view
