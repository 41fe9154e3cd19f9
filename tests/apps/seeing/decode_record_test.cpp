// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/decode_record.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>
#include <thread>

#include "run_palpate.h"

namespace palpate::apps {
namespace {

sensing::SourceFrame frame(std::size_t number) {
  return {.number = number, .name = std::to_string(number) + ".png", .file = {}, .read = {}};
}

FinishedFrame finished(std::size_t number) {
  FinishedFrame result = stamped(frame(number));
  result.pixels = 10;
  result.median_depth = 700.1;
  return result;
}

DecodeRecord record_in(const ScratchFolder& scratch) {
  return {scratch.path(), {{"--window", 2.0}}, {"frames"}};
}

TEST(DecodeRecord, FindsOnlyWhatAnEarlierRunFinished) {
  const ScratchFolder scratch;
  {
    DecodeRecord record = record_in(scratch);
    record.begin();
    record.add(finished(0));
    EXPECT_EQ(record.find(frame(0)), nullptr);
  }
  DecodeRecord again = record_in(scratch);
  again.resume();
  ASSERT_NE(again.find(frame(0)), nullptr);
  EXPECT_EQ(again.find(frame(0))->median_depth, 700.1);
  EXPECT_EQ(again.find(frame(1)), nullptr);
}

// As in the pipeline, where one stage looks for finished frames while another adds them. With
// -fsanitize=thread this also shows that they share no data.
TEST(DecodeRecord, FindsWhileAnotherThreadAdds) {
  constexpr std::size_t kFrames = 2000;
  const ScratchFolder scratch;
  {
    DecodeRecord record = record_in(scratch);
    record.begin();
    for (std::size_t i = 0; i < kFrames; ++i) record.add(finished(i));
  }
  DecodeRecord record = record_in(scratch);
  record.resume();
  record.begin();
  std::thread adding([&] {
    for (std::size_t i = 0; i < 2 * kFrames; ++i) record.add(finished(i));
  });
  std::size_t found = 0;
  for (std::size_t i = 0; i < 2 * kFrames; ++i) found += record.find(frame(i)) != nullptr ? 1 : 0;
  adding.join();
  EXPECT_EQ(found, kFrames);
}

TEST(DecodeRecord, CountsAFrameOnceThatWasDecodedAgain) {
  const ScratchFolder scratch;
  DecodeRecord record = record_in(scratch);
  record.begin();
  for (const std::size_t number : {0, 1, 0}) record.add(finished(number));
  EXPECT_EQ(count_finished_frames(scratch / "decode.jsonl"), 2u);
  record.write_table();
  EXPECT_EQ(read_text(scratch / "frames.csv"),
            "range_map,frame\n000000.tiff,0.png\n000001.tiff,1.png\n");
}

}  // namespace
}  // namespace palpate::apps
