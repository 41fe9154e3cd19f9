// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate::devices {

/// Of SCHED_FIFO, 1 to 99: that of the haptic loop and of the processes of drivers. Above interrupt
/// threads (50), so that a busy disk does not delay a tick.
constexpr int kRealTimePriority = 80;

/// Asks for SCHED_FIFO for the calling thread.
/// \returns why it is not allowed; empty if it is.
[[nodiscard]] std::string ask_for_real_time(int priority = kRealTimePriority);

}  // namespace palpate::devices
