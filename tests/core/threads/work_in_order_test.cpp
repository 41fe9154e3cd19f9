// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/work_in_order.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <memory>
#include <optional>
#include <stdexcept>
#include <thread>
#include <vector>

#include "palpate/core/error.h"

namespace palpate {
namespace {

/// Numbers from 0 to `count`.
auto counting(int count) {
  return [count, i = 0]() mutable -> std::optional<int> {
    return i < count ? std::optional<int>(i++) : std::nullopt;
  };
}

TEST(WorkInOrder, DeliversInOrderWhateverTheWorkTakes) {
  std::vector<int> delivered;
  work_in_order<int>(
      counting(200),
      [](int& i) {
        std::this_thread::sleep_for(std::chrono::microseconds(i % 7 == 0 ? 2000 : 50));
        i *= 3;
      },
      [&](int& i) { delivered.push_back(i); }, 8);
  ASSERT_EQ(delivered.size(), 200u);
  for (int i = 0; i < 200; ++i) EXPECT_EQ(delivered[static_cast<std::size_t>(i)], 3 * i);
}

/// Counts those that are alive.
struct Counted {
  explicit Counted(std::atomic<int>& live) : live_(&live) { ++live; }
  Counted(Counted&& other) noexcept : live_(other.live_) { ++*live_; }
  Counted(const Counted& other) : live_(other.live_) { ++*live_; }
  Counted& operator=(const Counted&) = delete;
  ~Counted() { --*live_; }
  std::atomic<int>* live_;
};

TEST(WorkInOrder, HoldsNoMoreThanItMayAtOnce) {
  for (const int max_live : {1, 3, 10}) {
    std::atomic<int> live = 0, most = 0;
    int left = 1000;
    int delivered = 0;
    work_in_order<Counted>(
        [&]() -> std::optional<Counted> {
          if (left-- == 0) return std::nullopt;
          return std::optional<Counted>(std::in_place, live);
        },
        [&](Counted&) {
          int seen = most;
          while (live > seen && !most.compare_exchange_weak(seen, live)) {
          }
        },
        [&](Counted&) {
          // A slow end lets the others pile up.
          if (++delivered % 100 == 0) std::this_thread::sleep_for(std::chrono::milliseconds(2));
        },
        max_live);
    EXPECT_EQ(delivered, 1000);
    EXPECT_EQ(live, 0);
    // One more lives while it is moved into the pipeline.
    EXPECT_LE(most, max_live + 1);
  }
}

TEST(WorkInOrder, PassesOnWhatIsThrownAndEnds) {
  struct Stop {};
  int delivered = 0;
  const auto nothing = [](int&) {};
  EXPECT_THROW(work_in_order<int>(
                   counting(1000000), nothing,
                   [&](int& i) {
                     if (i == 50) throw Stop{};
                     ++delivered;
                   },
                   4),
               Stop);
  EXPECT_EQ(delivered, 50);
  EXPECT_THROW(work_in_order<int>(
                   counting(1000000), [](int&) { throw OutputError("full"); }, nothing, 4),
               OutputError);
  EXPECT_THROW(work_in_order<int>([]() -> std::optional<int> { throw FileError("gone"); }, nothing,
                                  nothing, 4),
               FileError);
}

TEST(WorkInOrder, KeepsNoItemWhateverIsThrown) {
  using Shared = std::shared_ptr<int>;
  const Shared shared = std::make_shared<int>(0);
  for (const int last : {0, 1, 50}) {
    EXPECT_THROW(work_in_order<Shared>([&] { return std::optional(shared); }, [](Shared&) {},
                                       [&, left = last](Shared&) mutable {
                                         if (left-- == 0) throw OutputError("full");
                                       },
                                       8),
                 OutputError);
    EXPECT_EQ(shared.use_count(), 1);
  }
}

TEST(WorkInOrder, NothingToDoAndAWrongLimit) {
  const auto nothing = [](int&) {};
  EXPECT_NO_THROW(work_in_order<int>(counting(0), nothing, nothing, 1));
  EXPECT_THROW(work_in_order<int>(counting(3), nothing, nothing, 0), InvalidInput);
  EXPECT_GE(usual_live_items(), 1);
  EXPECT_LE(usual_live_items(), 100);
}

}  // namespace
}  // namespace palpate
