// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/parallel_for.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <stdexcept>
#include <vector>

namespace palpate {
namespace {

TEST(ParallelFor, CallsTheBodyOnceForEachIndex) {
  for (const int count : {0, 1, 2, 7, 10'007}) {
    std::vector<std::atomic<int>> calls(static_cast<std::size_t>(count));
    parallel_for(count, [&](int i) { ++calls[static_cast<std::size_t>(i)]; });
    EXPECT_TRUE(std::all_of(calls.begin(), calls.end(), [](const auto& n) { return n == 1; }))
        << "count " << count;
  }
}

TEST(ParallelFor, CallsNothingForANegativeCount) {
  parallel_for(-1, [](int) { FAIL(); });
}

TEST(ParallelFor, PassesOnWhatTheBodyThrows) {
  EXPECT_THROW(parallel_for(1000,
                            [](int i) {
                              if (i == 700) throw std::runtime_error("700");
                            }),
               std::runtime_error);
}

TEST(ParallelRanges, CoverAllIndicesInRangesThatAreNotTooSmall) {
  constexpr std::ptrdiff_t kCount = 1001, kGrain = 64;
  std::vector<std::atomic<int>> calls(kCount);
  parallel_ranges(kCount, kGrain, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    EXPECT_GE(end - begin, kGrain / 2);
    for (std::ptrdiff_t i = begin; i < end; ++i) ++calls[static_cast<std::size_t>(i)];
  });
  EXPECT_TRUE(std::all_of(calls.begin(), calls.end(), [](const auto& n) { return n == 1; }));
}

}  // namespace
}  // namespace palpate
