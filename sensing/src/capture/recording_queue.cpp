// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "capture/recording_queue.h"

#include <algorithm>
#include <utility>

namespace palpate::sensing {
namespace {

std::size_t bytes_of_frame(const RecordedFrame& frame) {
  return frame.image.total() * frame.image.elemSize();
}

std::optional<RecordedFrame> first_of(std::deque<RecordedFrame>& frames) {
  if (frames.empty()) return std::nullopt;
  RecordedFrame frame = std::move(frames.front());
  frames.pop_front();
  return frame;
}

}  // namespace

bool RecordingQueue::put(const RecordedFrame& frame) {
  {
    const std::lock_guard lock(mutex_);
    const std::size_t bytes = bytes_of_frame(frame);
    if (unwritten_ > 0 && bytes_ + bytes > memory_) return false;
    bytes_ += bytes;
    most_waiting_ = std::max(most_waiting_, ++unwritten_);
    to_write_.push_back(frame);
    if (decodes_) {
      to_decode_.push_back(frame);
      if (to_decode_.size() > kMostBehind) {
        to_decode_.pop_front();
        ++skipped_;
      }
    }
  }
  to_write_news_.notify_one();
  to_decode_news_.notify_one();
  return true;
}

std::optional<RecordedFrame> RecordingQueue::take_to_write() {
  std::unique_lock lock(mutex_);
  to_write_news_.wait(lock, [&] { return closed_ || !to_write_.empty(); });
  return first_of(to_write_);
}

void RecordingQueue::written(const RecordedFrame& frame) {
  const std::lock_guard lock(mutex_);
  bytes_ -= bytes_of_frame(frame);
  --unwritten_;
}

std::optional<RecordedFrame> RecordingQueue::take_to_decode() {
  std::unique_lock lock(mutex_);
  to_decode_news_.wait(lock, [&] { return closed_ || !to_decode_.empty(); });
  return first_of(to_decode_);
}

void RecordingQueue::close() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
  }
  to_write_news_.notify_all();
  to_decode_news_.notify_all();
}

void RecordingQueue::abort() {
  {
    const std::lock_guard lock(mutex_);
    to_write_.clear();
    to_decode_.clear();
  }
  close();
}

std::size_t RecordingQueue::skipped() const {
  const std::lock_guard lock(mutex_);
  return skipped_;
}

std::size_t RecordingQueue::most_waiting() const {
  const std::lock_guard lock(mutex_);
  return most_waiting_;
}

}  // namespace palpate::sensing
