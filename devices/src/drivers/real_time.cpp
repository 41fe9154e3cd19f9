// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/real_time.h"

#include <pthread.h>
#include <sched.h>

#include <cstring>

namespace palpate::devices {

std::string ask_for_real_time(int priority) {
  sched_param parameters{};
  parameters.sched_priority = priority;
  const int refused = pthread_setschedparam(pthread_self(), SCHED_FIFO, &parameters);
  return refused == 0 ? std::string() : std::strerror(refused);
}

}  // namespace palpate::devices
