// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "offscreen_display.h"

#include <gtest/gtest.h>

#include <array>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include "child_processes.h"
#include "picture_test_utils.h"

// After the others: it defines words like None, Bool and Success as macros.
#include <X11/Xlib.h>

namespace palpate::pictures {
namespace {

/// Waits until a process has ended; false if it takes more than ten seconds.
bool ends(pid_t process) {
  for (int attempt = 0; attempt < 1000 && !has_ended(process); ++attempt) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return has_ended(process);
}

/// The output of another process that uses a display; `settings` go before its command.
std::string use_display(const std::string& manner, const std::string& settings = "") {
  FILE* output = popen((settings + " '" + DISPLAY_USER + "' '" + manner + "' 2>&1").c_str(), "r");
  std::string text;
  std::array<char, 4096> part{};
  while (const std::size_t size = std::fread(part.data(), 1, part.size(), output)) {
    text.append(part.data(), size);
  }
  pclose(output);
  return text;
}

/// The one child that it had; -1 if it had none or several.
pid_t only_child_in(const std::string& output) {
  const std::string words = "1 children: ";
  const auto at = output.find(words);
  return at == std::string::npos ? -1 : std::atoi(output.c_str() + at + words.size());
}

TEST(OffscreenDisplay, StartsOneServerForAllConnections) {
  {
    const OffscreenDisplay first;
    EXPECT_NE(first.handle(), nullptr);
  }
  const std::vector<pid_t> servers = child_processes();
  EXPECT_EQ(servers.size(), 1U);
  { const OffscreenDisplay second; }
  EXPECT_EQ(child_processes(), servers);
}

TEST(OffscreenDisplay, StartsAnotherServerWhereTheFirstIsGone) {
  { const OffscreenDisplay first; }
  const std::vector<pid_t> servers = child_processes();
  ASSERT_EQ(servers.size(), 1U);
  kill(servers[0], SIGTERM);
  ASSERT_TRUE(ends(servers[0]));
  const OffscreenDisplay second;
  EXPECT_NE(second.handle(), nullptr);
  ASSERT_EQ(child_processes().size(), 1U) << "no zombie";
  EXPECT_NE(child_processes(), servers);
}

TEST(OffscreenDisplay, StartsItsServerWhereDisplayNamesNone) {
  EXPECT_GT(only_child_in(use_display("", "DISPLAY=:54321")), 0);
}

TEST(OffscreenDisplay, TakesTheServerThatDisplayNames) {
  // This process lends its own.
  const OffscreenDisplay lent;
  const std::string lent_name = DisplayString(static_cast<Display*>(lent.handle()));
  EXPECT_NE(use_display("", "DISPLAY=" + lent_name).find("0 children"), std::string::npos);
}

TEST(OffscreenDisplay, KeepsItsServerWhenTheThreadThatDrewFirstEnds) {
  EXPECT_GT(only_child_in(use_display("from a thread that ends")), 0);
}

TEST(OffscreenDisplay, EndsItsServerWithTheProcess) {
  const pid_t server = only_child_in(use_display(""));
  ASSERT_GT(server, 0);
  // The process waited for it, so that it is not even a zombie.
  EXPECT_FALSE(std::filesystem::exists("/proc/" + std::to_string(server)));
}

TEST(OffscreenDisplay, EndsItsServerEvenIfTheProcessIsKilled) {
  const pid_t server = only_child_in(use_display("and is killed"));
  ASSERT_GT(server, 0);
  EXPECT_TRUE(ends(server));
}

TEST(OffscreenDisplay, SaysWhatToInstallWhereThereIsNoServer) {
  const std::string output = use_display("", "PATH=/nowhere:/neither");
  EXPECT_NE(output.find("install the package xvfb"), std::string::npos) << output;
}

TEST(OffscreenDisplay, SaysWhereTheServerDoesNotStart) {
  const ScratchFolder folder;
  std::filesystem::create_symlink("/bin/false", folder / "Xvfb");
  const std::string output = use_display("", "PATH=" + (folder / "").string());
  EXPECT_NE(output.find("does not start"), std::string::npos) << output;
  EXPECT_NE(output.find("0 children"), std::string::npos) << output;
}

}  // namespace
}  // namespace palpate::pictures
