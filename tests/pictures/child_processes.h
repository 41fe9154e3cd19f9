// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <sys/types.h>

#include <vector>

namespace palpate::pictures {

/// Processes that this one started and did not wait for yet, zombies too.
[[nodiscard]] std::vector<pid_t> child_processes();

/// Returns true if there is no such process, or it only waits for its parent to take notice.
[[nodiscard]] bool has_ended(pid_t process);

}  // namespace palpate::pictures
