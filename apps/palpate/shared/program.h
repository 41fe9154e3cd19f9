// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>

#include "shared/aliases.h"

namespace palpate::apps {

// Exit statuses of the programs.
inline constexpr int kProgramDone = 0;
inline constexpr int kProgramFailed = 1;     ///< the work failed
inline constexpr int kProgramWrongCall = 2;  ///< the call or an input file is wrong

/// Runs a program: messages go to standard error after its name, Ctrl-C ends it with one line, and
/// an exception becomes a message and an exit status.
/// \return the result of `run`, or the status of its exception.
[[nodiscard]] int run_program(const char* name, const std::function<int()>& run);

/// The file of this program.
/// \throws FileError if /proc is not mounted.
[[nodiscard]] fs::path program_file();

/// The folder of this program.
/// \throws FileError if /proc is not mounted.
[[nodiscard]] fs::path program_folder();

/// Returns a file or folder that comes with the command.
/// \param installed its path relative to the folder of the command, \param in_build its path if
/// the command runs in the folder in which it was built.
/// \throws FileError if there is none, and as `program_folder`.
[[nodiscard]] fs::path bundled(const fs::path& installed, const fs::path& in_build);

}  // namespace palpate::apps
