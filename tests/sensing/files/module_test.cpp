// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <atomic>
#include <opencv2/core.hpp>
#include <thread>
#include <vector>

#include "palpate/sensing/frame.h"
#include "palpate/sensing/tiff_frame.h"
#include "test_files.h"

namespace palpate::sensing {
namespace {

TEST(Module, ThreadsMayNeedItForTheFirstTimeAtOnce) {
  const ScratchFolder folder;
  cv::Mat image(20, 30, CV_16UC3);
  cv::randu(image, 0, 65535);
  std::atomic<int> same = 0;
  std::vector<std::thread> threads;
  for (int i = 0; i < 8; ++i) {
    threads.emplace_back([&, file = folder / (std::to_string(i) + ".tiff")] {
      write_tiff(file, image);
      same += cv::norm(read_frame(file), image, cv::NORM_INF) == 0 ? 1 : 0;
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(same, 8);
}

}  // namespace
}  // namespace palpate::sensing
