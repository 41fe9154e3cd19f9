// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/progress.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <memory>
#include <optional>
#include <utility>

namespace palpate::apps {
namespace {

constexpr int kBarWidth = 40;                        // characters
constexpr auto kPatience = std::chrono::seconds(1);  // shorter work shows no bar
constexpr auto kRedraw = std::chrono::milliseconds(100);

std::mutex latest_mutex;
std::string latest_work;  // guarded by the mutex

}  // namespace

std::string time_left(double seconds) {
  const auto minutes = static_cast<long long>(std::ceil(seconds / 60));
  if (seconds < 60) return fmt::format(", {:.0f} s left", std::ceil(seconds));
  if (minutes < 60) return fmt::format(", {} min left", minutes);
  return fmt::format(", {} h {} min left", minutes / 60, minutes % 60);
}

Progress::Progress(std::string what)
    : what_(std::move(what)), terminal_(isatty(STDERR_FILENO) != 0), start_(Clock::now()) {
  const std::lock_guard lock(latest_mutex);
  latest_work = what_;
}

std::string Progress::latest() {
  const std::lock_guard lock(latest_mutex);
  return latest_work;
}

Progress::~Progress() {
  if (shown_) std::fputs("\r\x1b[K", stderr);
}

void Progress::update(int done, int total) {
  InterruptedByThrowing::check();
  if (total <= 0 || !spdlog::should_log(spdlog::level::warn)) return;
  const Clock::time_point now = Clock::now();
  const std::lock_guard lock(mutex_);
  if (!counting_) {
    counting_ = true;
    first_done_ = done;
    first_ = now;
  }
  if (now - start_ < kPatience) return;
  const double passed = std::chrono::duration<double>(now - first_).count();
  const std::string left = done > first_done_ && done < total
                               ? time_left(passed * (total - done) / (done - first_done_))
                               : std::string();
  if (!terminal_) {
    print_line(done, total, left);
  } else if (now - drawn_ >= kRedraw || done >= total) {
    drawn_ = now;
    draw_bar(done, total, left);
  }
}

void Progress::draw_bar(int done, int total, const std::string& left) {
  const auto filled = static_cast<int>(static_cast<long long>(kBarWidth) * done / total);
  const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                          std::string(static_cast<std::size_t>(kBarWidth - filled), ' ');
  std::fputs(fmt::format("\r{} [{}] {} of {}{}\x1b[K", what_, bar, done, total, left).c_str(),
             stderr);
  std::fflush(stderr);
  shown_ = true;
}

void Progress::print_line(int done, int total, const std::string& left) {
  const long long tenths = 10LL * done / total;
  if (tenths <= tenths_) return;
  tenths_ = tenths;
  std::fputs(fmt::format("palpate: {}: {} of {}{}\n", what_, done, total, left).c_str(), stderr);
}

std::function<void(int done, int total)> shown_as(const std::string& what) {
  // Shared, because the callback of an option can be copied.
  return [progress = std::make_shared<std::optional<Progress>>(), what](int done, int total) {
    if (!*progress) progress->emplace(what);
    (*progress)->show(done, total);
    if (done == total) progress->reset();  // then Ctrl-C ends the program at once
  };
}

}  // namespace palpate::apps
