// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "device/tick_clock.h"

#include <algorithm>
#include <cmath>
#include <ctime>

namespace palpate::haptics {
namespace {

double monotonic_seconds() noexcept {
  timespec time{};
  clock_gettime(CLOCK_MONOTONIC, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

void sleep_until(double seconds) noexcept {
  const double whole = std::floor(seconds);
  timespec time{};
  time.tv_sec = static_cast<time_t>(whole);
  time.tv_nsec = static_cast<long>(1e9 * (seconds - whole));
  while (clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &time, nullptr) != 0) {
  }
}

}  // namespace

double TickClock::now() const noexcept {
  return real_time_ ? monotonic_seconds() : static_cast<double>(ticks_) * period_;
}

int TickClock::wait() noexcept {
  if (!real_time_) {
    ++ticks_;
    return 1;
  }
  if (ticks_ == 0) start_ = monotonic_seconds();
  sleep_until(start_ + static_cast<double>(ticks_ + 1) * period_);
  const auto reached = static_cast<long long>((monotonic_seconds() - start_) / period_);
  const long long passed = std::max(reached - ticks_, 1LL);
  ticks_ += passed;
  return static_cast<int>(std::min<long long>(passed, kMostTicks));
}

}  // namespace palpate::haptics
