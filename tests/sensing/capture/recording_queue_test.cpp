// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "capture/recording_queue.h"

#include <gtest/gtest.h>

#include <thread>
#include <vector>

namespace palpate::sensing {
namespace {

constexpr std::size_t kBytes = 100;  // of a frame

RecordedFrame frame(std::uint64_t number) {
  return {.image = cv::Mat(10, 10, CV_8U, cv::Scalar(0)),
          .number = number,
          .index = static_cast<std::size_t>(number)};
}

TEST(RecordingQueue, EveryFrameIsWrittenInOrder) {
  RecordingQueue queue(10 * kBytes, false);
  for (std::uint64_t i = 0; i < 10; ++i) EXPECT_TRUE(queue.put(frame(i)));
  queue.close();
  for (std::uint64_t i = 0; i < 10; ++i) EXPECT_EQ(queue.take_to_write()->number, i);
  EXPECT_FALSE(queue.take_to_write());
  EXPECT_EQ(queue.most_waiting(), 10U);
}

TEST(RecordingQueue, RefusesAFrameForWhichThereIsNoMemoryUntilOneIsWritten) {
  RecordingQueue queue(3 * kBytes, false);
  for (std::uint64_t i = 0; i < 3; ++i) EXPECT_TRUE(queue.put(frame(i)));
  EXPECT_FALSE(queue.put(frame(3)));
  const auto first = queue.take_to_write();
  EXPECT_FALSE(queue.put(frame(4)));  // it is being written, and still in memory
  queue.written(*first);
  EXPECT_TRUE(queue.put(frame(5)));
  EXPECT_EQ(queue.most_waiting(), 3U);
}

TEST(RecordingQueue, AcceptsAFrameThatIsLargerThanTheMemory) {
  RecordingQueue queue(kBytes / 2, false);
  EXPECT_TRUE(queue.put(frame(0)));
  EXPECT_FALSE(queue.put(frame(1)));
}

TEST(RecordingQueue, DecodingBeginsWithTheNewestTwoAndSkipsTheRest) {
  RecordingQueue queue(10 * kBytes, true);
  for (std::uint64_t i = 0; i < 6; ++i) EXPECT_TRUE(queue.put(frame(i)));
  EXPECT_EQ(queue.take_to_decode()->number, 4U);
  EXPECT_TRUE(queue.put(frame(6)));
  EXPECT_TRUE(queue.put(frame(7)));
  EXPECT_EQ(queue.skipped(), 5U);
  queue.close();
  EXPECT_EQ(queue.take_to_decode()->number, 6U);
  EXPECT_EQ(queue.take_to_decode()->number, 7U);
  EXPECT_FALSE(queue.take_to_decode());
  for (std::uint64_t i = 0; i < 8; ++i) EXPECT_EQ(queue.take_to_write()->number, i);
}

TEST(RecordingQueue, AbortDropsWhatWaits) {
  RecordingQueue queue(10 * kBytes, true);
  EXPECT_TRUE(queue.put(frame(0)));
  queue.abort();
  EXPECT_FALSE(queue.take_to_write());
  EXPECT_FALSE(queue.take_to_decode());
}

TEST(RecordingQueue, ThreadsThatWaitAreWokenByFramesAndByTheEnd) {
  RecordingQueue queue(100 * kBytes, false);
  std::vector<std::size_t> counts(4);
  std::vector<std::thread> threads;
  for (std::size_t& count : counts) {
    threads.emplace_back([&] {
      while (queue.take_to_write()) ++count;
    });
  }
  for (std::uint64_t i = 0; i < 50; ++i) EXPECT_TRUE(queue.put(frame(i)));
  queue.close();
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(counts[0] + counts[1] + counts[2] + counts[3], 50U);
}

}  // namespace
}  // namespace palpate::sensing
