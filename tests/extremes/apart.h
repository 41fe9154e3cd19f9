// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

namespace palpate::extremes {

/// The limits of a task.
struct Limits {
  int seconds = 5;                    ///< of processor time, of all its threads
  std::size_t bytes = 2'000'000'000;  ///< of memory, beside what the process has when it begins
  int threads = 1;                    ///< as many as TBB may use
};

enum class End {
  finished,
  refused,  ///< by a palpate::Error
  failed,   ///< by another exception
  crashed,
  out_of_time,
  out_of_memory
};

/// "finished", "refused", ...
[[nodiscard]] const char* to_string(End end);

struct Outcome {
  End end = End::finished;
  std::string text = {};  ///< the result of the task, or why there is none
  double seconds = 0;     ///< [s] of processor time, if it ended by itself
};

/// Runs tasks one after the other in a process of its own, so that a crash or an endless run is the
/// outcome of one task, not the end of all. After either, the next task gets a new process.
///
/// The calling process must have no other threads: a task has only the one that calls it, and what
/// it starts itself.
[[nodiscard]] std::vector<Outcome> run_apart(std::size_t count,
                                             const std::function<std::string(std::size_t)>& task,
                                             const Limits& limits = {});

/// True if the program is built with a sanitizer, which takes many times the time and memory.
[[nodiscard]] bool is_sanitized();

}  // namespace palpate::extremes
