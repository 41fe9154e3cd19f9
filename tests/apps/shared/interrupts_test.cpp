// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/interrupts.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <functional>
#include <iterator>
#include <ostream>
#include <string>
#include <thread>

#include "palpate/core/output_file.h"
#include "run_palpate.h"

namespace palpate::apps {
namespace {

namespace fs = std::filesystem;

/// A program that watches for interrupts and does `work`, which calls its argument when it wants
/// Ctrl-C; it gets `count` of them.
CommandResult interrupted(const ScratchFolder& scratch, int count,
                          const std::function<void(const std::function<void()>& ready)>& work) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
  const std::string err = scratch / "err";
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    spdlog::set_default_logger(spdlog::stderr_color_mt("palpate"));
    std::signal(SIGINT, SIG_DFL);
    watch_for_interrupts();
    try {
      work([&] { [[maybe_unused]] const ssize_t told = ::write(ends[1], "", 1); });
    } catch (const Interrupted&) {
      ::_exit(1);
    }
    ::_exit(0);
  }
  for (char byte = 0; count > 0 && ::read(ends[0], &byte, 1) == 1; --count) ::kill(child, SIGINT);
  int status = 0;
  ::waitpid(child, &status, 0);
  ::close(ends[0]);
  ::close(ends[1]);
  return {.status = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status),
          .out = "",
          .err = read_text(err)};
}

[[noreturn]] void sleep_for_ever() {
  while (true) std::this_thread::sleep_for(std::chrono::hours(1));
}

TEST(Interrupts, EndTheProgramWithOneLineAndNoTemporaries) {
  const ScratchFolder scratch;
  write_text(scratch / "result.txt", "old");
  const CommandResult result = interrupted(scratch, 1, [&](const auto& ready) {
    write_file(scratch / "result.txt", [&](std::ostream& out) {
      out << "half" << std::flush;
      ready();
      sleep_for_ever();
    });
  });
  EXPECT_EQ(result.status, kInterruptedStatus);
  EXPECT_NE(result.err.find("interrupted; "), std::string::npos) << result.err;
  EXPECT_EQ(result.err.find('\n'), result.err.size() - 1) << result.err;
  EXPECT_EQ(read_text(scratch / "result.txt"), "old");
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch.path()), fs::directory_iterator()), 2);
}

TEST(Interrupts, AreThrownWhereTheyAreAskedFor) {
  const ScratchFolder scratch;
  const CommandResult result = interrupted(scratch, 1, [](const auto& ready) {
    const InterruptedByThrowing interrupts;
    ready();
    while (true) {
      interrupts.check();
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  });
  EXPECT_EQ(result.status, 1);
  EXPECT_EQ(result.err.find("interrupted; "), std::string::npos) << result.err;
}

TEST(Interrupts, EndTheProgramSoonIfNobodyAsks) {
  const ScratchFolder scratch;
  write_text(scratch / "result.txt", "old");
  const CommandResult result = interrupted(scratch, 1, [&](const auto& ready) {
    const InterruptedByThrowing interrupts;
    const InterruptMessage all({}, "continue with --resume");
    const InterruptMessage kept("no frame is kept");
    InterruptMessage::set_kept("1 frame is kept");
    write_file(scratch / "result.txt", [&](std::ostream& out) {
      out << "half" << std::flush;
      ready();
      sleep_for_ever();
    });
  });
  EXPECT_EQ(result.status, kInterruptedStatus);
  const std::size_t told = result.err.find("stopping; press Ctrl-C again to end at once\n");
  const std::size_t ended =
      result.err.find("interrupted; 1 frame is kept; continue with --resume\n");
  EXPECT_NE(ended, std::string::npos) << result.err;
  EXPECT_LT(told, ended) << result.err;
  EXPECT_EQ(std::distance(fs::directory_iterator(scratch.path()), fs::directory_iterator()), 2);
}

TEST(Interrupts, GiveWhatMustNotBeHurriedAllItsTime) {
  const ScratchFolder scratch;
  const CommandResult result = interrupted(scratch, 1, [](const auto& ready) {
    const InterruptedWithoutHaste interrupts;
    ready();
    std::this_thread::sleep_for(kLongestStop + std::chrono::milliseconds(300));
    InterruptedByThrowing::check();
  });
  EXPECT_EQ(result.status, 1) << result.err;
}

TEST(Interrupts, EndTheProgramAtTheSecondOneWhateverItDoes) {
  const ScratchFolder scratch;
  const CommandResult result = interrupted(scratch, 2, [](const auto& ready) {
    const InterruptedWithoutHaste interrupts;
    ready();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    ready();
    sleep_for_ever();
  });
  EXPECT_EQ(result.status, kInterruptedStatus);
}

TEST(Interrupts, LeaveAProgramAloneThatIsEnding) {
  const ScratchFolder scratch;
  const CommandResult result = interrupted(scratch, 1, [](const auto& ready) {
    const InterruptedByThrowing interrupts;
    ready();
    try {
      while (true) InterruptedByThrowing::check();
    } catch (const Interrupted&) {
      stop_watching();
    }
    std::this_thread::sleep_for(kLongestStop + std::chrono::milliseconds(300));
  });
  EXPECT_EQ(result.status, 0);
  EXPECT_EQ(result.err, "");
}

TEST(Interrupts, StayIgnoredIfTheProgramWasStartedSo) {
  const ScratchFolder scratch;
  const CommandResult result = interrupted(scratch, 0, [](const auto&) {
    std::signal(SIGINT, SIG_IGN);
    watch_for_interrupts();
    std::raise(SIGINT);
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  });
  EXPECT_EQ(result.status, 0);
}

}  // namespace
}  // namespace palpate::apps
