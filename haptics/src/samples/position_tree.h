// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

namespace palpate::haptics {

/// Finds positions near a place, in a time of the order of log N. Thread-safe.
class PositionTree {
 public:
  /// \param positions [mm] finite, in columns.
  explicit PositionTree(const Eigen::Matrix3Xd& positions);
  ~PositionTree();

  /// Up to `count` > 0 nearest of the positions that are wanted, in no order; of several at the
  /// same distance, any.
  [[nodiscard]] std::vector<std::size_t> nearest(
      const Eigen::Vector3d& place, std::size_t count,
      const std::function<bool(std::size_t)>& is_wanted) const;

  /// Those of which no coordinate differs by more than `reach` [mm], and perhaps some that differ
  /// by more, by rounding; in no order.
  [[nodiscard]] std::vector<std::size_t> in_cube(const Eigen::Vector3d& place, double reach) const;

 private:
  struct Impl;
  std::unique_ptr<const Impl> impl_;
};

}  // namespace palpate::haptics
