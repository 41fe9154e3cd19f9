// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surfaces/range_map_feed.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <cstdint>
#include <thread>
#include <utility>

#include "palpate/core/error.h"

namespace palpate::apps {
namespace {

using FeedClock = std::chrono::steady_clock;

constexpr std::chrono::milliseconds kBetweenLooks{100};

/// What changes while a file is written.
using FileState = std::pair<std::uintmax_t, fs::file_time_type>;

std::optional<FileState> state_of(const fs::path& file) {
  std::error_code size_error, time_error;
  const FileState state{fs::file_size(file, size_error), fs::last_write_time(file, time_error)};
  if (size_error || time_error || state.first == 0) return std::nullopt;
  return state;
}

}  // namespace

RangeMapFeed::RangeMapFeed(fs::path folder, const MapCamera& camera, std::optional<double> patience)
    : folder_(std::move(folder)), camera_(camera) {
  if (patience) {
    patience_ = std::chrono::duration<double>(*patience);
    look();
  } else {
    known_ = list_range_maps({folder_}, camera_);
  }
}

bool RangeMapFeed::wait_for(std::size_t index, const std::function<void()>& while_waiting) {
  if (!patience_) return index < known_.size();
  const FeedClock::time_point start = FeedClock::now();
  std::optional<FileState> before;
  while (known_.size() <= index + 1) {
    while_waiting();
    look();
    if (known_.size() == index + 1) {
      const std::optional<FileState> now = state_of(known_[index]);
      if (now && now == before) return true;
      before = now;
    } else if (known_.size() <= index && FeedClock::now() - start > *patience_) {
      if (known_.empty()) known_ = list_range_maps({folder_}, camera_);
      return index < known_.size();
    }
    if (known_.size() <= index + 1) std::this_thread::sleep_for(kBetweenLooks);
  }
  return true;
}

void RangeMapFeed::look() {
  try {
    add_new(list_range_maps({folder_}, camera_));
  } catch (const FileError&) {
    // Nothing is in the folder yet, or its newest file is not complete.
  }
}

void RangeMapFeed::add_new(const std::vector<fs::path>& listed) {
  auto first_new = listed.begin();
  if (!known_.empty()) {
    const auto last = std::ranges::find(listed, known_.back());
    if (last == listed.end()) return;
    for (const fs::path& file : std::vector(listed.begin(), last)) {
      if (std::ranges::find(known_, file) != known_.end() || !late_.insert(file).second) continue;
      spdlog::warn("{}: came after {}, which follows it; it is left out", file.string(),
                   known_.back().filename().string());
    }
    first_new = last + 1;
  }
  known_.insert(known_.end(), first_new, listed.end());
}

}  // namespace palpate::apps
