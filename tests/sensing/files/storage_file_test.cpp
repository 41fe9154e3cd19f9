// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/storage_file.h"

#include <gtest/gtest.h>

#include <array>
#include <opencv2/core/utils/logger.hpp>
#include <optional>
#include <thread>

namespace palpate::sensing {
namespace {

using cv::utils::logging::getLogLevel;

TEST(QuietOpenCv, LeavesTheLogLevelAsItWasWhateverTheOrderInWhichTheyGo) {
  const auto before = getLogLevel();
  ASSERT_NE(before, cv::utils::logging::LOG_LEVEL_SILENT);
  std::optional<QuietOpenCv> first, second;
  first.emplace();
  second.emplace();
  first.reset();
  EXPECT_EQ(getLogLevel(), cv::utils::logging::LOG_LEVEL_SILENT);
  second.reset();
  EXPECT_EQ(getLogLevel(), before);
}

TEST(QuietOpenCv, WorksInSeveralThreadsAtOnce) {
  const auto before = getLogLevel();
  std::array<std::thread, 4> threads;
  for (std::thread& thread : threads) {
    thread = std::thread([] {
      for (int round = 0; round < 1000; ++round) const QuietOpenCv quiet;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(getLogLevel(), before);
}

}  // namespace
}  // namespace palpate::sensing
