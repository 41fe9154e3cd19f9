// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "playback/packed_kernels.h"
#include "playback/slip_searcher.h"

namespace palpate::haptics {
namespace {

constexpr int kMaxInBracket = 12;  // evaluations
constexpr int kMaxDownhill = 12;   // steps
constexpr int kMaxShorter = 5;     // evaluations for each step, each a third as far as the last
constexpr int kDirections = 8;     // around the nearest point
constexpr std::size_t kBest = 5;   // of the places there, from which to go downhill
// Distances there, of that from the nearest point to the tool: all around it, and then, since a
// tool that has just touched beside the bottom of a sharp groove is held far up the flank, beyond.
constexpr std::array<std::array<double, 3>, 2> kDistances = {{{0.25, 0.5, 1.0}, {2.0, 5.0, 12.0}}};
// Finally, of the distance to the contacts, over which field and cone change. The cone may turn by
// a right angle within a part of it. The depth of the tool says nothing about that.
constexpr std::array kWidest = {1.0 / 32, 1.0 / 16, 0.125, 0.25, 0.5, 1.0};
// Along which slopes are measured, relative to the size of the surface.
constexpr double kProbe = 1e-5;
// Added to the squared slopes, in parts of their trace, so that steps are finite and not far longer
// than the slopes hold.
constexpr double kDamping = 1e-4;

}  // namespace

// The search away from the start, in the order of what is likely and costs least. A contact that
// slips off the border goes nowhere else.
void SlipSearcher::far_away(SlipMemory& memory) {
  from_nearest(memory);
  if (!is_root(best_)) downhill(best_);
  if (is_at_border()) return;
  if (!is_root(best_)) downhill(nearest_);
  if (!is_root(best_)) downhill(start_);
  const double to_tool = (tool_ - nearest_.at.position).norm();
  for (const auto& distances : kDistances)
    if (!is_root(best_)) around_nearest(to_tool, distances);
  if (!is_root(best_)) around_nearest(scale_of_contacts(nearest_.at), kWidest);
}

// To the farthest of the contacts that the place has weights of: field and cone change over it.
double SlipSearcher::scale_of_contacts(const SurfacePlace& at) {
  evaluate(at);
  double farthest = 0;
  for (std::size_t k = 0; k < static_cast<std::size_t>(place_.count); ++k) {
    const auto& constants = place_.constants[k / 4];
    const auto coordinate = [&](std::size_t i) {
      return constants[packed::kPosition + i].of[k % 4];
    };
    const Eigen::Vector3d position(coordinate(0), coordinate(1), coordinate(2));
    farthest = std::max(farthest, (position - at.position).norm());
  }
  return farthest;
}

// The force at the nearest point is along the normal, more or less: there a contact is likely to
// hold, so that a root lies on the way from there to the start, or near.
void SlipSearcher::from_nearest(SlipMemory& memory) {
  const geometry::ClosestPoint nearest = field_.blended().surface().closest_point(tool_);
  if (nearest.at.triangle < 0) return;
  const SlidingContact before = best_;
  const std::optional<Eigen::Vector3d> border = border_;
  best_ = evaluate({nearest.at.triangle, nearest.position});
  nearest_ = best_;
  if (best_.parts.normal >= 0 && best_.parts.excess < 0 && !is_root(best_)) {
    back_to_start();
  } else if (best_.parts.normal >= 0 && !is_root(best_)) {
    in_plane(memory, kMaxInPlane);
  }
  if (is_root(best_)) return;
  best_ = before;
  border_ = border;
}

// From the best place, which holds, towards the start, until a place there does not hold.
void SlipSearcher::back_to_start() {
  const SlidingContact from = best_;
  const Eigen::Vector3d way = start_.at.position - from.at.position;
  const Eigen::Vector3d plane = way.cross(axis_);
  double holds = 0, excess = from.parts.excess;
  double at = way.norm() / 2;
  for (int i = 0; i < kMaxInBracket; ++i, at *= 2) {
    const Walk walk = surface_.walk(from.at, plane, way, at);
    evaluate(walk.at);
    keep_best();
    if (is_root(last_) || !std::isfinite(last_.parts.excess)) return;
    if (last_.parts.excess > 0)
      return bracket(from.at, plane, way, holds, excess, walk.length, last_.parts.excess);
    if (walk.border_edge >= 0) return;
    holds = walk.length;
    excess = last_.parts.excess;
  }
}

// A bracketed secant between a place that holds and one that slips, this far along a walk.
void SlipSearcher::bracket(const SurfacePlace& from, const Eigen::Vector3d& plane,
                           const Eigen::Vector3d& along, double holds, double excess_holding,
                           double slips, double excess_slipping) {
  bool last_slips = false, last_holds = false;
  for (int i = 0; i < kMaxInBracket && std::abs(slips - holds) > shortest_; ++i) {
    const double at = holds + excess_holding / (excess_holding - excess_slipping) * (slips - holds);
    evaluate(surface_.walk(from, plane, along, at).at);
    keep_best();
    const double excess = last_.parts.excess;
    if (is_root(last_) || !std::isfinite(excess)) return;
    (excess > 0 ? slips : holds) = at;
    (excess > 0 ? excess_slipping : excess_holding) = excess;
    // Two in a row on the same side: halve the weight of the other end (Illinois).
    if (excess > 0 && last_slips) excess_holding /= 2;
    if (!(excess > 0) && last_holds) excess_slipping /= 2;
    last_slips = excess > 0;
    last_holds = !last_slips;
  }
}

// Gauss and Newton's steps down the part of f_T beyond the cone, along the surface itself: across
// a crease, and where the friction cone leans to the side, the plane of f_T may be far from that of
// the surface.
void SlipSearcher::downhill(const SlidingContact& from) {
  double longest = longest_;
  SlidingContact here = evaluate(from.at);
  if (!(here.parts.excess > 0)) return;
  Eigen::Vector3d rest = beyond_cone();
  for (int i = 0; i < kMaxDownhill; ++i) {
    const Eigen::Vector3d& normal = surface_.normal(here.at.triangle);
    Eigen::Matrix<double, 3, 2> tangents, slopes = decltype(slopes)::Zero();
    tangents.col(0) = forward_.cross(normal).normalized();
    tangents.col(1) = normal.cross(tangents.col(0));
    for (int k = 0; k < 2; ++k) {
      const Eigen::Vector3d along = tangents.col(k);
      const Walk walk =
          surface_.walk(here.at, along.cross(normal), along, kProbe * surface_.size());
      if (!(walk.length > 0)) continue;  // at the border
      evaluate(walk.at);
      slopes.col(k) = (beyond_cone() - rest) / walk.length;
    }
    Eigen::Matrix2d square = slopes.transpose() * slopes;
    square.diagonal().array() += kDamping * square.trace();
    Eigen::Vector3d step = -tangents * square.inverse() * (slopes.transpose() * rest);
    if (!step.allFinite()) return;
    if (step.norm() > longest) step *= longest / step.norm();
    bool better = false;
    for (int k = 0; k < kMaxShorter && !better; ++k) {
      const Eigen::Vector3d plane = step.cross(normal);
      const Walk walk = surface_.walk(here.at, plane, step, step.norm());
      evaluate(walk.at);
      keep_best();
      if (is_root(last_)) return;
      if (last_.parts.excess < 0) {
        return bracket(here.at, plane, step, walk.length, last_.parts.excess, 0, here.parts.excess);
      }
      better = beyond_cone().norm() < rest.norm();
      if (!better) step /= 3;
    }
    if (!better) return;
    longest = std::max(longest, 2 * step.norm());
    here = last_;
    rest = beyond_cone();
  }
}

// To where a contact begins to slip on the way to the nearest place around the nearest point that
// holds it, on all sides of a crease; if none does, downhill from the best. The best are those of
// the smallest angle to the cone: beside the nearest point, the force itself may be small.
// \param unit of the distances [mm].
void SlipSearcher::around_nearest(double unit, std::span<const double> distances) {
  const Eigen::Vector3d& normal = surface_.normal(nearest_.at.triangle);
  const Eigen::Vector3d first = forward_.cross(normal).normalized(), second = normal.cross(first);
  struct Candidate {
    SlidingContact contact;
    double beyond = std::numeric_limits<double>::infinity();  // part of the force
  };
  std::array<Candidate, kBest> candidates;  // the best first
  for (const double part : distances) {
    for (int i = 0; i < kDirections; ++i) {
      const double angle = 2 * std::numbers::pi * i / kDirections;
      const Eigen::Vector3d along = std::cos(angle) * first + std::sin(angle) * second;
      const Eigen::Vector3d plane = along.cross(normal);
      const Walk walk = surface_.walk(nearest_.at, plane, along, part * unit);
      evaluate(walk.at);
      if (!(last_.parts.normal >= 0)) continue;
      keep_best();
      if (is_root(last_)) return;
      if (last_.parts.excess < 0 && nearest_.parts.excess > 0) {
        return bracket(nearest_.at, plane, along, walk.length, last_.parts.excess, 0,
                       nearest_.parts.excess);
      }
      Candidate here{last_, std::abs(last_.parts.excess) / last_.force.force.norm()};
      for (Candidate& other : candidates)
        if (here.beyond < other.beyond) std::swap(here, other);
    }
  }
  for (const Candidate& candidate : candidates) {
    if (is_root(best_) || !std::isfinite(candidate.beyond)) return;
    downhill(candidate.contact);
  }
}

}  // namespace palpate::haptics
