// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <thread>

#include "child_processes.h"
#include "offscreen_display.h"
#include "palpate/core/error.h"

using palpate::pictures::child_processes;
using palpate::pictures::OffscreenDisplay;

namespace {

/// [ms] in which a signal arrives.
constexpr std::chrono::milliseconds kSignalTime{300};

void use_display(const std::string& manner) {
  if (manner == "from a thread that ends") {
    std::thread([] { const OffscreenDisplay first; }).join();
    std::this_thread::sleep_for(kSignalTime);
  }
  const OffscreenDisplay display;
}

}  // namespace

/// Uses a display in the manner that the argument says, then prints the children that it has, or
/// why it could not. Run by offscreen_display_test.
int main(int argc, char** argv) {
  const std::string manner = argc > 1 ? argv[1] : "";
  try {
    use_display(manner);
  } catch (const palpate::OutputError& error) {
    std::printf("%s\n", error.what());
  }
  std::printf("%zu children:", child_processes().size());
  for (const pid_t child : child_processes()) {
    std::printf(" %d", static_cast<int>(child));
  }
  std::fflush(stdout);
  if (manner == "and is killed") {
    std::raise(SIGKILL);
  }
  return EXIT_SUCCESS;
}
