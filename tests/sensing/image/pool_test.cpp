// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "image/pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <thread>
#include <vector>

namespace palpate::sensing {
namespace {

struct Counted {
  Counted() { ++made; }
  static inline std::atomic<int> made = 0;
  int users = 0;
};

TEST(Pool, GivesBackWhatWasUsedBefore) {
  Pool<Counted> pool;
  Counted::made = 0;
  Counted* first = nullptr;
  {
    const auto loan = pool.borrow();
    first = loan.get();
    loan->users = 7;
  }
  const auto again = pool.borrow();
  EXPECT_EQ(again.get(), first);
  EXPECT_EQ(again->users, 7);
  const auto second = pool.borrow();  // while the first is out
  EXPECT_NE(second.get(), first);
  EXPECT_EQ(Counted::made, 2);
}

TEST(Pool, NeverLendsOneObjectToTwoThreads) {
  constexpr int kThreads = 4;
  constexpr int kLoans = 2000;
  Pool<Counted> pool;
  Counted::made = 0;
  std::atomic<int> shared = 0;
  std::vector<std::thread> threads;
  threads.reserve(kThreads);
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([&] {
      for (int k = 0; k < kLoans; ++k) {
        const auto loan = pool.borrow();
        if (++loan->users != 1) ++shared;
        --loan->users;
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(shared, 0);
  EXPECT_LE(Counted::made, kThreads);
}

}  // namespace
}  // namespace palpate::sensing
