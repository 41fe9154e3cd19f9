// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

namespace palpate::apps {

// Exit statuses of the programs.
inline constexpr int kProgramDone = 0;
inline constexpr int kProgramFailed = 1;     ///< the work failed
inline constexpr int kProgramWrongCall = 2;  ///< the call or an input file is wrong

/// Runs a program: messages go to standard error after its name, Ctrl-C ends it with one line, and
/// an exception becomes a message and an exit status.
/// \return what `run` returns, or the status of what it threw.
[[nodiscard]] int run_program(const char* name, const std::function<int()>& run);

}  // namespace palpate::apps
