// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/result_folder.h"

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;
using enum ResultFolder::Unfinished;

/// All files that are not hidden are results.
std::vector<fs::path> all_files(const fs::path& folder) {
  std::vector<fs::path> files;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    const fs::path name = entry.path().filename();
    if (!name.string().starts_with('.')) files.push_back(name);
  }
  return files;
}

bool is_mine(const fs::path& /*file*/) { return true; }

class ResultFolders : public ::testing::Test {
 protected:
  void SetUp() override {
    fs::create_directory(out);
    write_text(out / "a.ply", "old");
    write_text(out / "b.ply", "old");
  }

  ScratchFolder scratch;
  const fs::path out = scratch / "out";
};

TEST_F(ResultFolders, KeepEarlierResultsUntilTheNewOnesAreFinished) {
  ResultFolder folder(out, all_files, dropped);
  EXPECT_TRUE(folder.replaces());
  folder.begin();
  write_text(folder.place() / "a.ply", "new");
  fs::create_directory(folder.place() / "nodes");
  write_text(folder.place() / "nodes/c.ply", "new");
  EXPECT_EQ(read_text(out / "a.ply"), "old");
  folder.finish(is_mine);
  EXPECT_EQ(read_text(out / "a.ply"), "new");
  EXPECT_EQ(read_text(out / "nodes/c.ply"), "new");
  EXPECT_FALSE(fs::exists(out / "b.ply"));
  EXPECT_FALSE(folder.replaces());
}

TEST_F(ResultFolders, DropOrKeepWhatIsNotFinished) {
  for (const auto unfinished : {dropped, kept}) {
    {
      ResultFolder folder(out, all_files, unfinished);
      folder.begin();
      write_text(folder.place() / "a.ply", "new");
    }
    EXPECT_EQ(read_text(out / "a.ply"), "old");
    const ResultFolder next(out, all_files, resumed);
    EXPECT_EQ(next.replaces(), unfinished == kept);
    EXPECT_EQ(fs::exists(next.place() / "b.ply"), unfinished == dropped);
  }
  // Results that are not resumed are removed when another run begins, and not before.
  const ResultFolder anew(out, all_files, kept);
  EXPECT_TRUE(fs::exists(anew.place() / "a.ply"));
  anew.begin();
  EXPECT_TRUE(fs::is_empty(anew.place()));
}

TEST_F(ResultFolders, BelongToOneRunAtATimeUntilItIsKilled) {
  const pid_t other = ::fork();
  if (other == 0) {
    const ResultFolder folder(out, all_files, kept);
    write_text(scratch / "locked", "");
    while (true) ::pause();
  }
  while (!fs::exists(scratch / "locked")) ::usleep(1000);
  EXPECT_THROW(ResultFolder(out, all_files, kept), OutputError);
  ::kill(other, SIGKILL);
  ::waitpid(other, nullptr, 0);
  EXPECT_NO_THROW(ResultFolder(out, all_files, kept));
}

TEST_F(ResultFolders, ThatWereMadeForNothingAreRemoved) {
  { const ResultFolder folder(scratch / "new", all_files, kept); }
  EXPECT_FALSE(fs::exists(scratch / "new"));
}

}  // namespace
}  // namespace palpate::apps
