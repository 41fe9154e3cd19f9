// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/run_record.h"

#include <gtest/gtest.h>

#include <algorithm>

#include <string>

#include "palpate/core/error.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

const RunRecord kEmpty{.head = {{"settings", {{"--window", 2.0}}}}, .items = {}};

template <typename Exception, typename Action>
std::string message_of(Action&& action) {
  try {
    action();
  } catch (const Exception& error) {
    return error.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return {};
}

TEST(RunRecord, ReadsWhatWasWritten) {
  const ScratchFolder scratch;
  RunRecordWriter writer(scratch / "a.jsonl", {.head = kEmpty.head, .items = {{{"number", 1}}}});
  writer.add({{"number", 2}, {"depth", 0.1}});
  const RunRecord record = read_run_record(scratch / "a.jsonl", "");
  EXPECT_EQ(record.head, kEmpty.head);
  ASSERT_EQ(record.items.size(), 2u);
  EXPECT_EQ(record.items[0]["number"], 1);
  EXPECT_EQ(record.items[1]["depth"], 0.1);
}

TEST(RunRecord, WritesTheSameNumberOfBytesForEachItem) {
  const ScratchFolder scratch;
  RunRecordWriter writer(scratch / "a.jsonl", kEmpty);
  const std::string before = read_text(scratch / "a.jsonl");
  const nlohmann::ordered_json item = {{"number", 1}};
  for (int i = 1; i <= 100; ++i) {
    writer.add(item);
    const std::string now = read_text(scratch / "a.jsonl");
    ASSERT_EQ(now.size(), before.size() + static_cast<std::size_t>(i) * (item.dump().size() + 1));
    ASSERT_TRUE(now.starts_with(before));
  }
}

// A record cut at any byte, as by a crash, gives the items before the cut.
TEST(RunRecord, LosesOnlyTheLineThatACrashCutOff) {
  const ScratchFolder scratch;
  {
    RunRecordWriter writer(scratch / "a.jsonl", kEmpty);
    for (int i = 0; i < 3; ++i) writer.add({{"number", i}});
  }
  const std::string whole = read_text(scratch / "a.jsonl");
  const std::size_t head = whole.find('\n') + 1;
  for (std::size_t bytes = head; bytes <= whole.size(); ++bytes) {
    write_text(scratch / "cut.jsonl", whole.substr(0, bytes));
    const RunRecord record = read_run_record(scratch / "cut.jsonl", "");
    const std::string items = whole.substr(head, bytes - head);
    EXPECT_EQ(static_cast<std::ptrdiff_t>(record.items.size()),
              std::count(items.begin(), items.end(), '\n'));
    RunRecordWriter(scratch / "cut.jsonl", record).add({{"number", 7}});
    EXPECT_EQ(read_run_record(scratch / "cut.jsonl", "").items.size(), record.items.size() + 1);
  }
}

TEST(RunRecord, RefusesAFileThatIsNoneAndSaysWhere) {
  const ScratchFolder scratch;
  const auto refusal = [&](const std::string& text) {
    write_text(scratch / "a.jsonl", text);
    return message_of<FileError>(
        [&] { static_cast<void>(read_run_record(scratch / "a.jsonl", "Do this")); });
  };
  EXPECT_NE(refusal("").find("a.jsonl: line 1: is missing"), std::string::npos) << refusal("");
  EXPECT_NE(refusal("{\"settings\"").find("line 1: is missing or incomplete"), std::string::npos);
  EXPECT_NE(refusal("{}\nnonsense\n{}\n").find("line 2: is not JSON"), std::string::npos);
  EXPECT_NE(refusal("{}\nnonsense\n").find("Do this."), std::string::npos);
}

TEST(RunRecord, NamesTheSettingThatDiffersAndBothValues) {
  const nlohmann::ordered_json before = {{"--window", 2.0}, {"--half", false}};
  EXPECT_NO_THROW(check_same_settings("a.jsonl", before, before, ""));
  const std::string message = message_of<InvalidInput>([&] {
    check_same_settings("a.jsonl", before, {{"--window", 3.0}, {"--half", false}}, "Do this");
  });
  EXPECT_NE(message.find("a.jsonl: the earlier run had another --window: 2.0 then, 3.0 now"),
            std::string::npos)
      << message;
  // An option that the earlier version did not have.
  EXPECT_THROW(check_same_settings("a.jsonl", before, {{"--new", 1}}, ""), InvalidInput);
}

}  // namespace
}  // namespace palpate::apps
