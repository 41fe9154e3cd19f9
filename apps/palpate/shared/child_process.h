// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace palpate::apps {

/// The outcome of a program that was run.
struct ChildResult {
  int status = 0;  ///< its exit status; 128 + n after signal n
  std::string out, err;
};

/// Runs a program and waits until it has ended. It is not reached by Ctrl-C in the terminal.
/// \param words the program, which is looked up in PATH, and its arguments.
/// \throws OutputError if it cannot be started.
[[nodiscard]] ChildResult run_child(std::vector<std::string> words);

}  // namespace palpate::apps
