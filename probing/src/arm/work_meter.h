// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// The work [N mm] of a force that is commanded, less what the arm's own damping takes, along the
/// path of a tip. It takes means over blocks of ticks: the noise of encoders is in both the place
/// and the damping, so that single ticks would add up to a work that nobody did.
class WorkMeter {
 public:
  /// \param force [N], \param damping [N s/mm], \param block ticks of a mean; > 0.
  WorkMeter(double time, const Eigen::Vector3d& force, const Eigen::Vector3d& tip, double damping,
            int block)
      : damping_(damping), block_(block), latest_{time, force, tip} {}

  void add(double time, const Eigen::Vector3d& force, const Eigen::Vector3d& tip) {
    sum_.time += time;
    sum_.force += force;
    sum_.tip += tip;
    if (++count_ < block_) return;
    go_to({sum_.time / count_, sum_.force / count_, sum_.tip / count_}, damping_);
    sum_ = {};
    count_ = 0;
  }

  /// [N mm] with a last motion to where the tip rests.
  [[nodiscard]] double end(const Eigen::Vector3d& force, const Eigen::Vector3d& tip) {
    go_to({latest_.time, force, tip}, 0);
    return work_;
  }

 private:
  struct Point {
    double time = 0;
    Eigen::Vector3d force = Eigen::Vector3d::Zero(), tip = Eigen::Vector3d::Zero();
  };

  void go_to(const Point& next, double damping) {
    const Eigen::Vector3d way = next.tip - latest_.tip;
    work_ += way.dot(next.force + latest_.force) / 2;
    const double seconds = next.time - latest_.time;
    if (seconds > 0) work_ -= damping * way.squaredNorm() / seconds;
    latest_ = next;
  }

  double damping_;
  int block_;
  Point latest_, sum_;
  int count_ = 0;
  double work_ = 0;
};

}  // namespace palpate::probing
