// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/rate_law.h"

#include <cmath>

namespace palpate::haptics {
namespace {

// w = u - z after a time in which u changes evenly by `change`: dw/dt = du/dt - w / tau.
Eigen::Vector3d after(const Eigen::Vector3d& ahead, const Eigen::Vector3d& change, double seconds,
                      double time) {
  const double rest = std::exp(-seconds / time);
  const Eigen::Vector3d steady = change * (time / seconds);
  return steady + rest * (ahead - steady);
}

}  // namespace

double force_at_once(std::span<const RateTerm> terms) noexcept {
  double sum = 1;
  for (const RateTerm& term : terms) sum += term.share;
  return sum;
}

void relax(std::span<const RateTerm> terms, const Eigen::Vector3d& displacement, double seconds,
           DelayedDisplacements& delayed) noexcept {
  if (!(seconds > 0)) return;
  for (std::size_t i = 0; i < terms.size(); ++i) {
    const double part = -std::expm1(-seconds / terms[i].time);
    delayed.of[i] += part * (displacement - delayed.of[i]);
  }
}

Eigen::Matrix3Xd displacement_ahead(const ToolHistory& path, double time) {
  const Eigen::Matrix3Xd& u = path.displacements;
  const Eigen::Index count = u.cols();
  Eigen::Matrix3Xd ahead(3, count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto at = static_cast<std::size_t>(k);
    if (!path.begins[at]) {
      ahead.col(k) =
          after(ahead.col(k - 1), u.col(k) - u.col(k - 1), path.time[at] - path.time[at - 1], time);
      continue;
    }
    // Time that the tool took to come here.
    double seconds = 0;
    if (k + 1 < count && !path.begins[at + 1]) {
      const double further = u.col(k + 1).norm() - u.col(k).norm();
      if (further > 0) seconds = (path.time[at + 1] - path.time[at]) * u.col(k).norm() / further;
    }
    ahead.col(k) = u.col(k);
    if (seconds > 0) ahead.col(k) = after(Eigen::Vector3d::Zero(), u.col(k), seconds, time);
  }
  return ahead;
}

}  // namespace palpate::haptics
