// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "import/press_samples.h"

#include <cmath>
#include <optional>

namespace palpate::probing {
namespace {

constexpr double kTurnedForce =
    0.05;  // sine of the angle from which on a force or a path is turned

bool is_turned(const Eigen::Vector3d& vector, const Eigen::Vector3d& from) {
  const Eigen::Vector3d along = from.normalized();
  return (vector - vector.dot(along) * along).norm() > kTurnedForce * vector.norm();
}

/// Positions of the presses without a drag, by their force along the first one.
class PressCurve {
 public:
  explicit PressCurve(const Eigen::Vector3d& along) : along_(along) {}

  void add(const HeldPress& piece) { points_.push_back({piece.force.dot(along_), piece.tip}); }

  /// The position of the tip under this force; none if it is further than `tolerance` from all.
  [[nodiscard]] std::optional<Eigen::Vector3d> at(double force, double tolerance) const {
    const Point *below = nullptr, *above = nullptr;
    for (const Point& point : points_) {
      if (point.force <= force && (below == nullptr || point.force >= below->force)) below = &point;
      if (point.force >= force && (above == nullptr || point.force <= above->force)) above = &point;
    }
    if (below != nullptr && above != nullptr) {
      const double gap = above->force - below->force;
      const double share = gap > 0 ? (force - below->force) / gap : 0;
      return Eigen::Vector3d(below->tip + share * (above->tip - below->tip));
    }
    const Point* nearest = below != nullptr ? below : above;
    if (nearest == nullptr || !(std::abs(nearest->force - force) <= tolerance)) return std::nullopt;
    return nearest->tip;
  }

 private:
  struct Point {
    double force = 0;  // [N]
    Eigen::Vector3d tip;
  };
  Eigen::Vector3d along_;
  std::vector<Point> points_;
};

Sample sample_of_piece(const HeldPress& piece, const Eigen::Vector3d& a) {
  Sample sample;
  sample.force = piece.force;
  sample.a = a;
  sample.b = piece.tip;
  sample.time = piece.time;
  return sample;
}

}  // namespace

PressSamples samples_of_press(const SeriesPress& press, double touch_force) {
  constexpr double kNoise = 0.5;  // of mean forces, at most, relative to touch_force
  PressSamples result;
  if (press.held.empty()) return result;
  const Eigen::Vector3d along = press.held.front().force.normalized();
  Eigen::Vector3d way = press.held.front().tip - press.touch;  // of the latest press
  PressCurve curve(along);
  const auto add_drag = [&](const HeldPress& piece, bool slipped) {
    const std::optional<Eigen::Vector3d> a = curve.at(piece.force.dot(along), touch_force);
    if (!a) {
      ++result.drags_without_base;
      return;
    }
    result.samples.push_back(sample_of_piece(piece, *a));
    result.samples.back().slipped = slipped;
    result.dragged.push_back(true);
  };
  for (const HeldPress& piece : press.held) {
    const double across = (piece.force - piece.force.dot(along) * along).norm();
    if (across > kNoise * touch_force && is_turned(piece.force, along) &&
        is_turned(piece.tip - press.touch, way)) {
      add_drag(piece, false);
      continue;
    }
    curve.add(piece);
    way = piece.tip - press.touch;
    result.samples.push_back(sample_of_piece(piece, piece.tip));
    result.dragged.push_back(false);
  }
  if (press.slip) add_drag(*press.slip, true);
  return result;
}

}  // namespace palpate::probing
