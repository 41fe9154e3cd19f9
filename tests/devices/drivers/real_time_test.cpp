// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/real_time.h"

#include <gtest/gtest.h>
#include <pthread.h>
#include <sched.h>

#include <thread>

namespace palpate::devices {
namespace {

TEST(RealTime, IsGivenOrSaysWhyNot) {
  std::string refused;
  int policy = -1;
  sched_param parameters{};
  std::thread([&] {
    refused = ask_for_real_time(1);
    pthread_getschedparam(pthread_self(), &policy, &parameters);
  }).join();
  EXPECT_EQ(policy == SCHED_FIFO, refused.empty()) << refused;
  if (refused.empty()) {
    EXPECT_EQ(parameters.sched_priority, 1);
  }
  EXPECT_EQ(ask_for_real_time(1000), "Invalid argument");
}

}  // namespace
}  // namespace palpate::devices
