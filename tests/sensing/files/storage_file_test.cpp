// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "files/storage_file.h"

#include <gtest/gtest.h>

#include <array>
#include <opencv2/core/utils/logger.hpp>
#include <optional>
#include <string>
#include <thread>

#include "palpate/error.h"
#include "test_files.h"

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

TEST(StorageFile, RefusesWhatFollowsTheKeysAndValues) {
  const ScratchFolder folder;
  for (const char* rest : {"...\n- 3\n", "b: 1 }\n- 2\n"}) {  // OpenCV's parser hangs at the first
    const auto path = written(folder, "file.yaml", std::string("%YAML:1.0\n---\na: 1\n") + rest);
    const std::string message = message_of<FileError>([&] { const StorageFile file(path); });
    EXPECT_NE(message.find("file.yaml: line "), std::string::npos) << message;
  }
}

TEST(StorageFile, RefusesAMatrixWithoutItsNumbersBeforeItTakesMemory) {
  const ScratchFolder folder;
  for (const char* keys : {
           "   rows: 100000\n   cols: 100000\n   dt: d\n   data: [ 1.0 ]\n",
           "   rows: many\n   cols: 1\n   dt: d\n   data: [ 1.0 ]\n",
           "   rows: 1\n   cols: 1\n   dt: d\n   data: 1.0\n",
           "   rows: 1\n   cols: 1\n   dt: d\n",
           "   rows: -1\n   cols: -1\n   dt: d\n   data: [ 1.0 ]\n",
       }) {
    write_text(folder / "file.yaml", std::string("%YAML:1.0\n---\nm: !!opencv-matrix\n") + keys);
    const StorageFile file(folder / "file.yaml");
    const std::string message = message_of<FileError>([&] { (void)file.matrix("m"); });
    EXPECT_NE(message.find("file.yaml: m: a matrix is expected"), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace palpate::sensing
