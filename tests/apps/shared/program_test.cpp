// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/program.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>
#include <new>
#include <string>

#include "palpate/core/error.h"
#include "run_palpate.h"
#include "shared/progress.h"

namespace palpate::apps {
namespace {

/// Returns the output of a program whose work ends with an exception. It must fail.
std::string printed_by(int status, const std::function<int()>& run) {
  const ScratchFolder scratch;
  const std::string err = scratch / "err";
  const pid_t child = ::fork();
  if (child == 0) {
    ::dup2(::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600), STDERR_FILENO);
    ::_exit(run_program("palpate", run));
  }
  int ended = 0;
  ::waitpid(child, &ended, 0);
  EXPECT_TRUE(WIFEXITED(ended) && WEXITSTATUS(ended) == status) << ended;
  return read_text(err);
}

TEST(Program, TellsWhatNeededMoreMemoryThanThereIs) {
  EXPECT_EQ(printed_by(kProgramFailed,
                       []() -> int {
                         const Progress progress("fusing");
                         throw std::bad_alloc();
                       }),
            "palpate: error: there is not enough memory for fusing. Pass less at a time, or ask "
            "for less: a coarser spacing or resolution, a larger tolerance, or fewer --threads.\n");
}

TEST(Program, DoesNotShowTheTypesOfTheLibraries) {
  const auto refused = [](const char* message) {
    return printed_by(kProgramWrongCall, [&]() -> int { throw InvalidInput(message); });
  };
  EXPECT_EQ(refused("PlanOptions::contacts is -1; it must be > 0"),
            "palpate: error: contacts is -1; it must be > 0\n");
  EXPECT_EQ(refused("a.ply: raise RemeshingOptions::max_triangles"),
            "palpate: error: a.ply: raise max_triangles\n");
  EXPECT_EQ(refused("Scan::one.ply: there is no such file"),
            "palpate: error: Scan::one.ply: there is no such file\n");
}

}  // namespace
}  // namespace palpate::apps
