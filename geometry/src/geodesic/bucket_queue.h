// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <vector>

namespace palpate::geometry {

/// Queue of events at distances, nearest bucket first and first in first out within a bucket. This
/// is sufficient for propagation that corrects events that came too early; it needs no sorting and
/// keeps neighbours together.
/// \tparam Event  has a member `distance`
template <class Event>
class BucketQueue {
 public:
  /// \param width  of a bucket
  explicit BucketQueue(double width) : per_width_(1 / width) {}

  void push(const Event& event) {
    // For a width of 0 the product may be NaN, for which std::min returns its first argument.
    const auto wanted = static_cast<std::size_t>(std::min(kMost, event.distance * per_width_));
    const std::size_t bucket = std::max(wanted, nearest_);
    if (bucket >= buckets_.size()) buckets_.resize(bucket + 1);
    buckets_[bucket].push_back(event);
    ++count_;
  }

  /// Returns true if an event at a distance comes after all those of nearer buckets; the last
  /// bucket has no order.
  [[nodiscard]] bool is_in_order(double distance) const { return distance * per_width_ < kMost; }

  [[nodiscard]] std::optional<Event> pop() {
    if (count_ == 0) return std::nullopt;
    while (next_ == buckets_[nearest_].size()) close();
    --count_;
    return buckets_[nearest_][next_++];
  }

  /// Prepares the queue for events nearer than those popped. Precondition: it is empty.
  void restart() {
    if (nearest_ < buckets_.size()) close();
    nearest_ = 0;
  }

 private:
  static constexpr double kMost = 1 << 20;  ///< buckets; the last one takes the rest

  void close() {
    std::vector<Event>().swap(buckets_[nearest_++]);
    next_ = 0;
  }

  double per_width_;
  std::size_t count_ = 0;    ///< of events
  std::size_t nearest_ = 0;  ///< bucket
  std::size_t next_ = 0;     ///< event in it
  std::vector<std::vector<Event>> buckets_;
};

}  // namespace palpate::geometry
