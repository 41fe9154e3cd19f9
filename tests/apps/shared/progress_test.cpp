// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/progress.h"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <thread>

namespace palpate::apps {
namespace {

/// Returns the output for 40 pieces of work that take this time together, outside of a terminal.
std::string printed(std::chrono::milliseconds time) {
  ::testing::internal::CaptureStderr();
  {
    Progress progress("decoding");
    progress.show(0, 40);
    std::this_thread::sleep_for(time);
    for (int done = 1; done <= 40; ++done) progress.show(done, 40);
  }
  return ::testing::internal::GetCapturedStderr();
}

TEST(Progress, PrintsALineForEachTenthOutsideOfATerminal) {
  const std::string text = printed(std::chrono::milliseconds(1100));
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 10) << text;
  EXPECT_EQ(text.find("palpate: decoding: 4 of 40, "), 0U) << text;
  EXPECT_NE(text.find(" left\npalpate: decoding: 8 of 40"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with("palpate: decoding: 40 of 40\n")) << text;
  EXPECT_EQ(text.find('\r'), std::string::npos);
}

TEST(Progress, SaysNothingOfShortWorkOrWhereThereAreNoWarnings) {
  EXPECT_EQ(printed(std::chrono::milliseconds(0)), "");
  const auto level = spdlog::get_level();
  spdlog::set_level(spdlog::level::err);
  EXPECT_EQ(printed(std::chrono::milliseconds(1100)), "");
  spdlog::set_level(level);
}

TEST(Progress, OfAnOptionEndsWithTheWorkAndBeginsAnewWithTheNext) {
  ::testing::internal::CaptureStderr();
  const auto progress = shown_as("finding normals");
  progress(0, 2);
  std::this_thread::sleep_for(std::chrono::milliseconds(1100));
  progress(2, 2);
  progress(0, 2);  // short work, which is not reported
  progress(2, 2);
  EXPECT_EQ(::testing::internal::GetCapturedStderr(), "palpate: finding normals: 2 of 2\n");
}

}  // namespace
}  // namespace palpate::apps
