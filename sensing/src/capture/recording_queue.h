// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <condition_variable>
#include <cstddef>
#include <deque>
#include <mutex>
#include <optional>

#include "palpate/sensing/recording.h"

namespace palpate::sensing {

/// The queue between a camera and the threads that write and decode its frames. The camera never
/// waits: a frame for which there is no memory is refused. Every accepted frame is written, in
/// order. For decoding, the newest `kMostBehind` frames wait; older ones are skipped.
class RecordingQueue {
 public:
  /// Frames that may wait for decoding.
  static constexpr std::size_t kMostBehind = 2;

  /// \param memory [bytes] for frames that are not written yet; one frame is always accepted.
  RecordingQueue(std::size_t memory, bool decodes) : memory_(memory), decodes_(decodes) {}

  /// Adds a frame; never waits.
  /// \return false if there is no memory for it: it is lost.
  [[nodiscard]] bool put(const RecordedFrame& frame);
  /// The oldest frame that is not written, after waiting for one; empty when no more will come.
  [[nodiscard]] std::optional<RecordedFrame> take_to_write();
  /// Releases the memory of a frame.
  void written(const RecordedFrame& frame);
  /// The oldest of the frames that wait for decoding, after waiting for one; empty when no more
  /// will come.
  [[nodiscard]] std::optional<RecordedFrame> take_to_decode();
  /// No more frames come; those that wait are still taken.
  void close();
  /// Drops the frames that wait.
  void abort();

  /// Frames that were skipped by decoding.
  [[nodiscard]] std::size_t skipped() const;
  /// The largest number of frames that were waiting to be written.
  [[nodiscard]] std::size_t most_waiting() const;

 private:
  std::size_t memory_;
  bool decodes_;
  mutable std::mutex mutex_;
  std::condition_variable to_write_news_, to_decode_news_;
  std::deque<RecordedFrame> to_write_, to_decode_;
  std::size_t bytes_ = 0;      ///< of frames that are not written yet
  std::size_t unwritten_ = 0;  ///< their number
  std::size_t most_waiting_ = 0;
  std::size_t skipped_ = 0;
  bool closed_ = false;
};

}  // namespace palpate::sensing
