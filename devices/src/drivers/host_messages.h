// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>

#include "palpate/devices/device_plugin.h"

namespace palpate::devices {

/// The messages between `RemoteDevice` and `serve_device`; both are of the same build.
struct HostRequest {
  enum Kind : std::uint32_t { activate, read, write, stop };
  std::uint32_t kind = read;
  std::uint32_t number = 0;     ///< of the request; an answer has the same
  std::uint32_t real_time = 0;  ///< with `activate`: ask for SCHED_FIFO
  palpate_device_command_v1 command{};
};

/// To the beginning (number 0) and to each request but `write`.
struct HostAnswer {
  std::uint32_t number = 0;
  std::uint32_t done = 0;       ///< 0: it failed, see `words`
  std::uint32_t has_clock = 0;  ///< the device has a clock of its own
  std::uint32_t invalid = 0;    ///< at the beginning: the file or an argument is wrong
  std::uint32_t refused = 0;    ///< commands that the device did not take so far
  double now = 0;               ///< [s] of its clock
  palpate_device_info_v1 info{};
  palpate_device_state_v1 state{};
  char words[512] = {};
};

}  // namespace palpate::devices
