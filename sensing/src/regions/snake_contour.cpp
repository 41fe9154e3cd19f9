// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/snake_contour.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace palpate::sensing {
namespace {

using Eigen::Vector2d;

/// Forces in units of the expansion force. The unit of time is such that a straight front moves by
/// kTimeStep per round [px].
constexpr double kRigidity = SnakeContour::kCriticalRadius;
constexpr double kImageForce = 3;  ///< per roughness / px
constexpr double kTimeStep = 0.4;

/// Distances between neighbouring points [px]. The explicit steps are stable if
/// kTimeStep * kRigidity <= kNearest^2 / 2.
constexpr double kNearest = 1.8;
constexpr double kFarthest = 4;
static_assert(kTimeStep * kRigidity <= kNearest * kNearest / 2);

/// Longest move per round [px]; segments are never longer than kFarthest + 2 kLongestMove.
constexpr double kLongestMove = 0.5;

/// Cell size of the grid for finding neighbours [px]: two segments that cross start within two
/// segment lengths of each other.
constexpr double kCell = 12;
static_assert(kCell >= 2 * (kFarthest + 2 * kLongestMove));

/// A point that moved by less than kRest [px] for kPatience rounds sleeps until a neighbour moves.
constexpr double kRest = 0.04;
constexpr int kPatience = 4;

/// A contour is at rest if this many rounds add less than this area [px^2], which is far less than
/// the narrowest advancing front adds.
constexpr int kRoundsBetween = 100;
constexpr double kLeastGrowth = 20;

constexpr int kFewestPoints = 6;

double cross(const Vector2d& a, const Vector2d& b) { return a.x() * b.y() - a.y() * b.x(); }

/// Returns true if two segments have a point in common.
bool meet(const Vector2d& a, const Vector2d& b, const Vector2d& c, const Vector2d& d) {
  const double c_side = cross(b - a, c - a);
  const double d_side = cross(b - a, d - a);
  const double a_side = cross(d - c, a - c);
  const double b_side = cross(d - c, b - c);
  return c_side * d_side <= 0 && a_side * b_side <= 0;
}

}  // namespace

SnakeContour::SnakeContour(const Vector2d& center, double radius, const Plane& roughness,
                           const Labels& finished)
    : roughness_(&roughness),
      finished_(&finished),
      cells_across_(roughness.cols() / static_cast<long>(kCell) + 1),
      cells_(static_cast<std::size_t>(cells_across_ *
                                      (roughness.rows() / static_cast<long>(kCell) + 1))) {
  const int count =
      std::max(kFewestPoints, static_cast<int>(2 * std::numbers::pi * radius / (0.7 * kFarthest)));
  for (int i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * i / count;
    const Vector2d at = center + radius * Vector2d(std::cos(angle), std::sin(angle));
    points_.push_back({at, (i + count - 1) % count, (i + 1) % count, 0});
    cell_of(at).push_back(i);
  }
  count_ = count;
}

std::vector<int>& SnakeContour::cell_of(const Vector2d& at) {
  const auto column = static_cast<long>(std::max(0.0, at.x()) / kCell);
  const auto row = static_cast<long>(std::max(0.0, at.y()) / kCell);
  return cells_[static_cast<std::size_t>(row * cells_across_ + column)];
}

bool SnakeContour::open(const Vector2d& at) const {
  const long column = std::lround(at.x());
  const long row = std::lround(at.y());
  if (column < 0 || row < 0 || column >= roughness_->cols() || row >= roughness_->rows())
    return false;
  return (*finished_)(row, column) < 0;
}

/// Interpolates bilinearly between the central differences of the four pixels around a place.
Vector2d SnakeContour::gradient(const Vector2d& at) const {
  const Plane& q = *roughness_;
  const long last_column = q.cols() - 1;
  const long last_row = q.rows() - 1;
  const auto left = static_cast<long>(std::floor(at.x()));
  const auto top = static_cast<long>(std::floor(at.y()));
  Vector2d sum(0, 0);
  for (const long row : {top, top + 1}) {
    for (const long column : {left, left + 1}) {
      const long c = std::clamp(column, 0L, last_column);
      const long r = std::clamp(row, 0L, last_row);
      const double weight = (1 - std::abs(at.x() - static_cast<double>(column))) *
                            (1 - std::abs(at.y() - static_cast<double>(row)));
      const float right_minus_left = q(r, std::min(c + 1, last_column)) - q(r, std::max(c - 1, 0L));
      const float down_minus_up = q(std::min(r + 1, last_row), c) - q(std::max(r - 1, 0L), c);
      sum += weight / 2 *
             Vector2d(static_cast<double>(right_minus_left), static_cast<double>(down_minus_up));
    }
  }
  return sum;
}

Vector2d SnakeContour::force(const Point& point) const {
  const Vector2d& before = points_[static_cast<std::size_t>(point.previous)].at;
  const Vector2d& after = points_[static_cast<std::size_t>(point.next)].at;
  const Vector2d forth = after - point.at;
  const Vector2d back = point.at - before;
  const double forth_length = std::max(forth.norm(), kNearest / 2);
  const double back_length = std::max(back.norm(), kNearest / 2);
  const Vector2d tangent = (after - before).normalized();
  const Vector2d outward(tangent.y(), -tangent.x());
  const Vector2d curvature =
      2 * (forth / forth_length - back / back_length) / (forth_length + back_length);
  const double rough =
      static_cast<double>((*roughness_)(std::lround(point.at.y()), std::lround(point.at.x())));
  const Vector2d sum =
      std::max(0.0, 1 - rough) * outward + kRigidity * curvature - kImageForce * gradient(point.at);
  // Motion of points along the contour does not move the contour.
  return sum.dot(outward) * outward;
}

/// Returns true if a segment meets one of the contour, except those that begin at `first`, `last`
/// or between them in contour order.
bool SnakeContour::crosses(const Vector2d& a, const Vector2d& b, int first, int last) const {
  const long rows = static_cast<long>(cells_.size()) / cells_across_;
  const auto column = static_cast<long>(std::max(0.0, b.x()) / kCell);
  const auto row = static_cast<long>(std::max(0.0, b.y()) / kCell);
  const auto spared = [&](int number) {
    for (int at = first;; at = points_[static_cast<std::size_t>(at)].next) {
      if (at == number) return true;
      if (at == last) return false;
    }
  };
  for (long r = std::max(0L, row - 1); r <= std::min(rows - 1, row + 1); ++r) {
    for (long c = std::max(0L, column - 1); c <= std::min(cells_across_ - 1, column + 1); ++c) {
      for (const int number : cells_[static_cast<std::size_t>(r * cells_across_ + c)]) {
        const Point& other = points_[static_cast<std::size_t>(number)];
        if (!meet(a, b, other.at, points_[static_cast<std::size_t>(other.next)].at)) continue;
        if (!spared(number)) return true;
      }
    }
  }
  return false;
}

void SnakeContour::forget(int number) {
  std::erase(cell_of(points_[static_cast<std::size_t>(number)].at), number);
}

void SnakeContour::wake(int number) { points_[static_cast<std::size_t>(number)].still = 0; }

/// Returns true if the point moved farther than kRest.
bool SnakeContour::move(int number) {
  Point& point = points_[static_cast<std::size_t>(number)];
  Vector2d step = kTimeStep * force(point);
  const double length = step.norm();
  if (!(length >= kRest)) return false;
  if (length > kLongestMove) step *= kLongestMove / length;
  const Vector2d target = point.at + step;
  if (!open(target)) return false;
  const Point& before = points_[static_cast<std::size_t>(point.previous)];
  const Point& after = points_[static_cast<std::size_t>(point.next)];
  // The ends of the new segments are shared with neighbouring segments.
  if (crosses(before.at, target, before.previous, number)) return false;
  if (crosses(after.at, target, point.previous, point.next)) return false;
  forget(number);
  point.at = target;
  cell_of(target).push_back(number);
  return true;
}

void SnakeContour::split_after(int number) {
  const int next = points_[static_cast<std::size_t>(number)].next;
  const int added = static_cast<int>(points_.size());
  const Vector2d middle =
      (points_[static_cast<std::size_t>(number)].at + points_[static_cast<std::size_t>(next)].at) /
      2;
  points_.push_back({middle, number, next, 0});
  points_[static_cast<std::size_t>(number)].next = added;
  points_[static_cast<std::size_t>(next)].previous = added;
  cell_of(middle).push_back(added);
  ++count_;
}

bool SnakeContour::remove_after(int number) {
  Point& point = points_[static_cast<std::size_t>(number)];
  const int removed = point.next;
  Point& gone = points_[static_cast<std::size_t>(removed)];
  Point& after = points_[static_cast<std::size_t>(gone.next)];
  if (count_ <= kFewestPoints || (after.at - point.at).norm() > kFarthest) return false;
  if (crosses(point.at, after.at, point.previous, gone.next)) return false;
  forget(removed);
  point.next = gone.next;
  after.previous = number;
  gone.still = -1;
  --count_;
  return true;
}

void SnakeContour::resample(int number) {
  const Point& point = points_[static_cast<std::size_t>(number)];
  const int next = point.next;
  const double distance = (points_[static_cast<std::size_t>(next)].at - point.at).norm();
  if (distance > kFarthest) {
    split_after(number);
  } else if (distance < kNearest) {
    remove_after(number);
  }
}

double SnakeContour::area() const {
  double twice = 0;
  for (const Point& point : points_) {
    if (point.still >= 0)
      twice += cross(point.at, points_[static_cast<std::size_t>(point.next)].at);
  }
  return twice / 2;
}

/// Moves each awake point once. Returns whether any point moved.
bool SnakeContour::move_all() {
  bool moved = false;
  const int last = static_cast<int>(points_.size());
  for (int i = 0; i < last; ++i) {
    const auto number = static_cast<std::size_t>(i);
    if (points_[number].still < 0 || points_[number].still >= kPatience) continue;
    if (!move(i)) {
      ++points_[number].still;
      continue;
    }
    moved = true;
    points_[number].still = 0;
    const int previous = points_[number].previous;
    wake(previous);
    wake(points_[number].next);
    resample(i);
    resample(previous);
  }
  return moved;
}

bool SnakeContour::grow(int max_rounds) {
  double before = area();
  for (int round = 1; round <= max_rounds; ++round) {
    if (!move_all()) return true;
    if (round % kRoundsBetween != 0) continue;
    const double now = area();
    if (now - before < kLeastGrowth) return true;
    before = now;
  }
  return false;
}

Eigen::Matrix2Xd SnakeContour::points() const {
  Eigen::Matrix2Xd result(2, count_);
  int at = 0;
  while (points_[static_cast<std::size_t>(at)].still < 0) ++at;
  for (int i = 0; i < count_; ++i) {
    result.col(i) = points_[static_cast<std::size_t>(at)].at;
    at = points_[static_cast<std::size_t>(at)].next;
  }
  return result;
}

}  // namespace palpate::sensing
