// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/child_process.h"

#include <gtest/gtest.h>

#include <string>

#include "palpate/core/error.h"

namespace palpate::apps {
namespace {

TEST(ChildProcess, GivesItsStatusAndBothOutputs) {
  const ChildResult child = run_child({"sh", "-c", "echo found; echo wrong >&2; exit 3"});
  EXPECT_EQ(child.status, 3);
  EXPECT_EQ(child.out, "found\n");
  EXPECT_EQ(child.err, "wrong\n");
  EXPECT_EQ(run_child({"sh", "-c", "kill -9 $$"}).status, 128 + 9);
}

TEST(ChildProcess, IsNotStoppedByMuchOutput) {
  // Each is longer than a pipe takes at once, and comes before the other.
  const std::string lines = "seq 50000 >&2; seq 50000; seq 50000 >&2";
  const ChildResult child = run_child({"sh", "-c", lines});
  EXPECT_EQ(child.err.size(), 2 * child.out.size());
  EXPECT_TRUE(child.out.ends_with("\n50000\n"));
}

TEST(ChildProcess, IsNamedIfItCannotBeStarted) {
  try {
    (void)run_child({"no-such-program"});
    FAIL();
  } catch (const OutputError& error) {
    EXPECT_STREQ(error.what(), "no-such-program: cannot be started: No such file or directory.");
  }
}

}  // namespace
}  // namespace palpate::apps
