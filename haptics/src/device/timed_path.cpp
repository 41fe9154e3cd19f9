// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/timed_path.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "palpate/core/error.h"

namespace palpate::haptics {

TimedPath::TimedPath(std::vector<TrajectoryPoint> points, PathShape shape)
    : points_(std::move(points)), shape_(shape) {
  if (points_.empty()) throw InvalidInput("TimedPath: there is no point; at least one is needed");
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const TrajectoryPoint& point = points_[i];
    if (!std::isfinite(point.time) || !point.tool.allFinite()) {
      throw InvalidInput("TimedPath: point " + std::to_string(i) +
                         " is not finite; times and positions must be numbers");
    }
    if (i > 0 && !(point.time > points_[i - 1].time)) {
      throw InvalidInput("TimedPath: point " + std::to_string(i) +
                         " is not later than the one before; points must be in order of time");
    }
  }
}

Eigen::Vector3d TimedPath::position(double time) const noexcept {
  const double at = points_.front().time + time;
  if (!(at > points_.front().time)) return points_.front().tool;
  if (at >= points_.back().time) return points_.back().tool;
  const auto next = std::ranges::upper_bound(points_, at, {}, &TrajectoryPoint::time);
  const TrajectoryPoint& begin = *(next - 1);
  double way = (at - begin.time) / (next->time - begin.time);
  if (shape_ == PathShape::smooth) way *= way * way * (10 + way * (-15 + 6 * way));
  return begin.tool + way * (next->tool - begin.tool);
}

double TimedPath::duration() const noexcept { return points_.back().time - points_.front().time; }

}  // namespace palpate::haptics
