// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <limits>
#include <vector>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// The latest positions of a tip, and the line through them. Allocates only on construction.
class RestingWindow {
 public:
  explicit RestingWindow(int length) : at_(static_cast<std::size_t>(length < 2 ? 2 : length)) {}

  void add(double time, const Eigen::Vector3d& position) {
    at_[next_] = {time, position};
    next_ = (next_ + 1) % at_.size();
    count_ = count_ < at_.size() ? count_ + 1 : count_;
  }
  [[nodiscard]] bool full() const { return count_ == at_.size(); }

  /// [mm] Mean of the positions so far.
  [[nodiscard]] Eigen::Vector3d mean() const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < count_; ++i) sum += at_[i].position;
    return sum / static_cast<double>(count_);
  }

  /// [mm/s] From the mean of the earlier half to that of the later one; infinite before it is full.
  /// An oscillation of whole periods in each half does not count, other than in `speed`.
  [[nodiscard]] double speed_of_halves() const {
    if (!full()) return std::numeric_limits<double>::infinity();
    const std::size_t half = at_.size() / 2;
    Sample earlier, later;
    for (std::size_t i = 0; i < half; ++i) {
      const Sample& early = at_[(next_ + i) % at_.size()];
      const Sample& late = at_[(next_ + at_.size() - half + i) % at_.size()];
      earlier.time += early.time, earlier.position += early.position;
      later.time += late.time, later.position += late.position;
    }
    return (later.position - earlier.position).norm() / (later.time - earlier.time);
  }

  /// [mm/s] Slope of a line through the positions so far; infinite if there are fewer than two.
  [[nodiscard]] double speed() const {
    double middle = 0;
    for (std::size_t i = 0; i < count_; ++i) middle += at_[i].time / static_cast<double>(count_);
    double square = 0;
    Eigen::Vector3d product = Eigen::Vector3d::Zero();
    for (std::size_t i = 0; i < count_; ++i) {
      const double time = at_[i].time - middle;
      square += time * time;
      product += time * (at_[i].position - at_[0].position);
    }
    return square > 0 ? product.norm() / square : std::numeric_limits<double>::infinity();
  }

 private:
  struct Sample {
    double time = 0;  // [s]
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
  };
  std::vector<Sample> at_;
  std::size_t next_ = 0, count_ = 0;
};

}  // namespace palpate::probing
