// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "playback/slip_search.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "playback/slip_searcher.h"

namespace palpate::haptics {
namespace {

constexpr int kMaxOnSection = 8;   // evaluations along the section
constexpr int kMaxWarm = 6;        // in the plane before all others, with the last slip's Jacobian
constexpr double kFarthest = 1.3;  // end of the section, in lengths of the line of Eq 5.19
// The slope of the last slip is used if it agrees with the line's own estimate to this factor.
constexpr double kSlopeAgrees = 2;
// The first step in two dimensions is at most the line, and this much of the displacement.
constexpr double kFurther = 0.25;
// Below this part of the displacement the line is rounding: the tool is straight behind its
// contact.
constexpr double kNoLine = 1e-6;
// A contact is at the border if it is this near to where a walk ended there [mm]: some times the
// rounding of coordinates of up to 1e6 mm.
constexpr double kAtBorder = 1e-7;
// A Jacobian is used while its determinant is at least this much of its squared norm, which is as
// for stiffnesses in two directions that differ by a factor of 100. 0.5 is the most.
constexpr double kLeastDeterminant = 0.01;
// Largest ratio of the first stiffness in the plane to that of the whole displacement.
constexpr double kStiffest = 2;
// Stored energy counts as increased by more than this [N mm]: some rounding errors of energies up
// to 1e3 N mm.
constexpr double kEnergyRounding = 1e-11;

}  // namespace

SlipSearcher::SlipSearcher(const PackedField& field, const SurfaceWalk& surface,
                           const SlidingContact& start, const Eigen::Vector3d& tool,
                           const SlipSearchOptions& options, PlaceField& place)
    : field_(field),
      surface_(surface),
      start_(start),
      tool_(tool),
      options_(options),
      place_(place),
      axis_(place.friction_axis),
      best_(start),
      last_(start),
      nearest_(start) {
  const Eigen::Vector3d& normal = surface.normal(start.at.triangle);
  const double displacement = (tool - start.at.position).norm();
  tangential_ = start.force.force - start.parts.normal * place.cone_axis;
  line_ = slip_line(axis_, normal, tool - start.at.position);
  if (!(line_.norm() > kNoLine * displacement)) {
    // The contact slips because the cone leans: it follows f_T.
    const Eigen::Vector3d along = tangential_ - tangential_.dot(normal) * normal;
    line_ = kFurther * displacement / along.norm() * along;
  }
  length_ = line_.norm();
  longest_ = length_ + kFurther * displacement;
  shortest_ = kShortestBracket * surface.size();
  forward_ = line_ / length_;
  if (!(-axis_.dot(normal) >= kMinAxisCosine * axis_.norm())) axis_ = -normal;
}

SlidingContact SlipSearcher::search(SlipMemory& memory) {
  if (!(std::isfinite(length_) && length_ > 0)) return start_;
  if (!memory.in_plane.isZero(0)) in_plane(memory, kMaxWarm);
  if (!is_root(best_)) {
    best_ = start_;
    memory.in_plane.setZero();
    if (!along_section(memory.slope)) in_plane(memory, kMaxInPlane);
  }
  const bool found_near = is_root(best_);
  if (!found_near) far_away(memory);
  const bool found = is_root(best_);
  // A contact that slips off the border loses its energy.
  best_.off_border = !found && is_at_border();
  if (!best_.off_border) keep_energy();
  best_.found_near = found_near;
  if (last_.at.position != best_.at.position) static_cast<void>(evaluate(best_.at));
  return best_;
}

// The border ends the walk, and the contact would continue beyond it.
void SlipSearcher::note_border(const Walk& walk) {
  if (walk.border_edge < 0 || !(last_.parts.excess > options_.tolerance)) return;
  const int t = walk.at.triangle, k = walk.border_edge;
  const Eigen::Vector3d outward =
      (surface_.corner(t, k == 2 ? 0 : k + 1) - surface_.corner(t, k)).cross(surface_.normal(t));
  if (tangential_.dot(outward) > 0 && line_.dot(outward) > 0) border_ = walk.at.position;
}

bool SlipSearcher::is_at_border() const {
  return border_ && (best_.at.position - *border_).norm() <= kAtBorder;
}

// |f_T| - mu f_N, with -|f_T| beyond the place where f_T turns round. It falls along the section.
double SlipSearcher::signed_excess() const {
  const bool beyond = tangential_.dot(forward_) < 0;
  return last_.parts.excess - (beyond ? 2 * last_.parts.tangential : 0);
}
// f_T across the section is beyond the cone, so that no place near here is a root.
bool SlipSearcher::passes_beside() const {
  const double along = tangential_.dot(forward_);
  const double across = std::sqrt(std::max(0.0, tangential_.squaredNorm() - along * along));
  return across > std::max(0.0, last_.parts.tangential - last_.parts.excess);
}

// True if a root was found.
bool SlipSearcher::along_section(double& slope) {
  const Eigen::Vector3d plane = line_.cross(axis_);
  const double farthest = kFarthest * length_;
  double low = 0, low_excess = start_.parts.excess, before = 0, before_excess = low_excess;
  double high = -1, high_excess = 0;
  bool last_low = false, last_high = false;
  SurfacePlace low_place = start_.at;
  double at =
      length_ * start_.parts.excess / std::max(start_.parts.tangential, start_.parts.excess);
  if (slope < 0) {
    const double guess = -start_.parts.excess / slope;
    if (guess < kSlopeAgrees * at && kSlopeAgrees * guess > at) at = guess;
  }
  slope = 0;
  SurfacePlace from = start_.at;
  double from_at = 0;
  for (int i = 0; i < kMaxOnSection; ++i) {
    if (from_at > at) {
      from = low_place;
      from_at = low;
    }
    const Walk walk = surface_.walk(from, plane, forward_, at - from_at);
    const bool ended = walk.border_edge >= 0;
    if (ended) at = from_at + walk.length;
    evaluate(walk.at);
    note_border(walk);
    from = walk.at;
    from_at = at;
    const double excess = signed_excess();
    if (at > 0 && (i == 0 || std::abs(excess) < low_excess))
      slope = (excess - start_.parts.excess) / at;
    keep_best();
    if (is_root(last_)) return true;
    if (!std::isfinite(excess)) return false;
    if (excess > 0) {
      before = low;
      before_excess = low_excess;
      low = at;
      low_excess = excess;
      low_place = walk.at;
      if (ended || at >= farthest) return is_root(best_);
    } else {
      if (passes_beside()) return is_root(best_);
      high = at;
      high_excess = excess;
    }
    if (high < 0) {
      const double falls = (low_excess - before_excess) / (low - before);
      at = falls < 0 ? low - low_excess / falls : 2 * low;
      at = std::min({at, std::max(2 * low, length_), farthest});
      if (excess > 0 && !(at > low)) return is_root(best_);
    } else {
      // Two in a row on the same side: halve the weight of the other end (Illinois).
      if (excess > 0 && last_low) high_excess /= 2;
      if (!(excess > 0) && last_high) low_excess /= 2;
      last_low = excess > 0;
      last_high = !last_low;
      if (high - low < shortest_) return is_root(best_);
      at = low + low_excess / (low_excess - high_excess) * (high - low);
    }
  }
  return is_root(best_);
}

// Follows f_T from the best place so far.
void SlipSearcher::in_plane(SlipMemory& memory, int most) {
  if (last_.at.position != best_.at.position) evaluate(best_.at);
  Eigen::Matrix<double, 2, 3> axes;
  axes.row(0) = (forward_ - forward_.dot(axis_) / axis_.squaredNorm() * axis_).normalized();
  axes.row(1) = axis_.cross(Eigen::Vector3d(axes.row(0))).normalized();
  // The line may be far shorter than the displacement that the force comes from.
  const double whole = start_.force.force.norm() / (tool_ - start_.at.position).norm();
  double stiffness =
      std::max(-memory.slope, std::min(start_.parts.tangential / length_, kStiffest * whole));
  Eigen::Matrix2d jacobian = axes * memory.in_plane * axes.transpose();
  Eigen::Vector2d rest = axes * beyond_cone();
  double longest = longest_;
  for (int i = 0; i < most && !is_root(best_); ++i) {
    if (!(jacobian.determinant() > kLeastDeterminant * jacobian.squaredNorm()))
      jacobian = -stiffness * Eigen::Matrix2d::Identity();
    Eigen::Vector2d step = -jacobian.inverse() * rest;
    if (!step.allFinite()) return;
    if (step.norm() > longest) step *= longest / step.norm();
    const Eigen::Vector3d direction = axes.transpose() * step;
    const SurfacePlace from = best_.at;
    const Eigen::Vector3d along = slip_line(axis_, surface_.normal(from.triangle), direction);
    const Walk walk = surface_.walk(from, direction.cross(axis_), along, along.norm());
    const Eigen::Vector2d moved = axes * (walk.at.position - from.position);
    if (!(moved.norm() > shortest_)) return;
    evaluate(walk.at);
    note_border(walk);
    const Eigen::Vector2d now = axes * beyond_cone();
    // The stiffness along the step itself, for a Jacobian that cannot be used: if an object is far
    // softer in this direction than in others, any larger stiffness would make tiny steps.
    const double seen = (rest - now).dot(moved) / moved.squaredNorm();
    if (seen > 0) stiffness = seen;
    jacobian += (now - rest - jacobian * moved) * moved.transpose() / moved.squaredNorm();
    if (now.norm() < rest.norm() || is_root(last_)) {
      best_ = last_;
      rest = now;
      longest = std::max(longest, 2 * moved.norm());
    } else {
      longest = moved.norm() / 2;
    }
  }
  memory.in_plane = axes.transpose() * jacobian * axes;
}

// If the result costs more than there is: the farthest place on the way there that does not, by a
// parabola through three places and the chord after it.
void SlipSearcher::keep_energy() {
  const double limit = std::max(options_.budget, cost_of(start_, options_.moved)) + kEnergyRounding;
  const SlidingContact end = best_;
  const double at_start = cost_of(start_, options_.moved) - limit,
               at_end = cost_of(end, options_.moved) - limit;
  if (!(at_end > 0)) return;
  const Eigen::Vector3d way = end.at.position - start_.at.position;
  const Eigen::Vector3d plane = way.cross(axis_);
  const double length = way.norm();
  double low = 0, low_cost = at_start, high = 1, high_cost = at_end;
  best_ = start_;
  const auto try_at = [&](double part) {
    evaluate(surface_.walk(start_.at, plane, way, part * length).at);
    const double here = cost_of(last_, options_.moved) - limit;
    if (here <= 0) {
      low = part;
      low_cost = here;
      best_ = last_;
    } else {
      high = part;
      high_cost = here;
    }
    return here;
  };
  const double middle = try_at(0.5);
  const double curvature = 2 * (at_start - 2 * middle + at_end);
  const double slope = 4 * middle - 3 * at_start - at_end;
  const double root = std::sqrt(std::max(0.0, slope * slope - 4 * curvature * at_start));
  const double crossing =
      slope > 0 ? -2 * at_start / (slope + root) : (root - slope) / (2 * curvature);
  if (crossing > low && crossing < high) try_at(crossing);
  if ((high - low) * length > shortest_)
    try_at(low + low_cost / (low_cost - high_cost) * (high - low));
  // A contact that pulls would be lost, and all of its energy.
  if (best_.parts.normal < 0 && end.parts.normal >= 0) best_ = end;
}

SlidingContact search_slip(const PackedField& field, const SurfaceWalk& surface,
                           const SlidingContact& start, const Eigen::Vector3d& tool,
                           const SlipSearchOptions& options, PlaceField& place,
                           SlipMemory& memory) noexcept {
  return SlipSearcher(field, surface, start, tool, options, place).search(memory);
}

}  // namespace palpate::haptics
