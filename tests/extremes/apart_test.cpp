// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "apart.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>
#include <stdexcept>

#include "palpate/core/error.h"

namespace palpate::extremes {
namespace {

TEST(Apart, EachWayToEndIsTheOutcomeOfOneTask) {
  const std::vector<Outcome> outcomes =
      run_apart(7,
                [](std::size_t task) -> std::string {
                  if (task == 1) throw InvalidInput("width is -1");
                  if (task == 2) throw std::logic_error("not ours");
                  if (task == 3) std::raise(SIGSEGV);
                  for (volatile int turning = 1; task == 4 && turning == 1;) {
                  }
                  if (task == 5) throw std::bad_alloc();
                  return "task " + std::to_string(task);
                },
                {.seconds = 1});
  const std::vector<End> expected = {End::finished, End::refused,     End::failed,
                                     End::crashed,  End::out_of_time, End::out_of_memory,
                                     End::finished};
  ASSERT_EQ(outcomes.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(outcomes[i].end, expected[i]) << i << ": " << outcomes[i].text;
  EXPECT_EQ(outcomes[0].text, "task 0");
  EXPECT_EQ(outcomes[1].text, "width is -1");
  EXPECT_EQ(outcomes[6].text, "task 6");
}

TEST(Apart, MemoryIsLimited) {
  if (is_sanitized()) GTEST_SKIP() << "sanitizers reserve addresses without end";
  const std::vector<Outcome> outcomes =
      run_apart(1, [](std::size_t) { return std::string(3'000'000'000, ' ').substr(0, 1); });
  EXPECT_EQ(outcomes.front().end, End::out_of_memory);
}

TEST(Apart, TheProcessIsAnother) {
  const std::vector<Outcome> outcomes =
      run_apart(2, [](std::size_t) { return std::to_string(getpid()); });
  EXPECT_NE(outcomes[0].text, std::to_string(getpid()));
  EXPECT_EQ(outcomes[0].text, outcomes[1].text);
}

}  // namespace
}  // namespace palpate::extremes
