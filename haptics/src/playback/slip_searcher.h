// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <optional>
#include <span>

#include "playback/slip_search.h"

namespace palpate::haptics {

// The bracket is exhausted when it is this short, relative to the size of the surface.
inline constexpr double kShortestBracket = 1e-11;
inline constexpr int kMaxInPlane = 16;  // evaluations by Broyden's method

/// One search for the place where a slip ends: `search_slip`.
class SlipSearcher {
 public:
  SlipSearcher(const PackedField& field, const SurfaceWalk& surface, const SlidingContact& start,
               const Eigen::Vector3d& tool, const SlipSearchOptions& options, PlaceField& place);

  SlidingContact search(SlipMemory& memory);

 private:
  const PackedField& field_;
  const SurfaceWalk& surface_;
  const SlidingContact& start_;
  const Eigen::Vector3d& tool_;
  const SlipSearchOptions& options_;
  PlaceField& place_;
  Eigen::Vector3d axis_, line_, forward_;
  double length_, shortest_;  // [mm] of the line of Eq 5.19, and of a bracket
  double longest_;            // [mm] first step in two dimensions
  SlidingContact best_, last_, nearest_;
  std::optional<Eigen::Vector3d> border_;  // a place from which the contact would go on beyond it
  Eigen::Vector3d tangential_ = Eigen::Vector3d::Zero();  // f_T of `last_`

  const SlidingContact& evaluate(const SurfacePlace& at) {
    field_.move_to(surface_.point(at), at.position, place_);
    last_.at = at;
    last_.force = field_.force(place_, tool_ - at.position, options_.delayed);
    last_.parts = friction_parts(place_, last_.force.force);
    tangential_ = last_.force.force - last_.parts.normal * place_.cone_axis;
    return last_;
  }

  // Without friction, a place that pulls may be on the cone, too.
  [[nodiscard]] bool is_root(const SlidingContact& at) const {
    return at.parts.normal >= 0 && std::abs(at.parts.excess) <= options_.tolerance;
  }

  // Keeps the last place if it is the best so far; any that pushes is better than one that pulls. A
  // place with NaN is not kept.
  void keep_best() {
    const bool pulls = !(last_.parts.normal >= 0), best_pulls = !(best_.parts.normal >= 0);
    if (pulls != best_pulls ? best_pulls
                            : std::abs(last_.parts.excess) < std::abs(best_.parts.excess))
      best_ = last_;
  }

  // The part of f_T beyond the cone.
  [[nodiscard]] Eigen::Vector3d beyond_cone() const {
    const double limit = std::max(0.0, last_.parts.tangential - last_.parts.excess);
    const double part = last_.parts.tangential > 0 ? 1 - limit / last_.parts.tangential : 0;
    return part * tangential_;
  }

  // slip_search.cpp: near the start.
  void note_border(const Walk& walk);
  [[nodiscard]] bool is_at_border() const;
  [[nodiscard]] double signed_excess() const;
  [[nodiscard]] bool passes_beside() const;
  bool along_section(double& slope);
  void in_plane(SlipMemory& memory, int most);
  void keep_energy();

  // far_search.cpp: after jumps, and across creases.
  void far_away(SlipMemory& memory);
  void from_nearest(SlipMemory& memory);
  void back_to_start();
  void bracket(const SurfacePlace& from, const Eigen::Vector3d& plane, const Eigen::Vector3d& along,
               double holds, double excess_holding, double slips, double excess_slipping);
  void downhill(const SlidingContact& from);
  void around_nearest(double unit, std::span<const double> distances);
  double scale_of_contacts(const SurfacePlace& at);
};

}  // namespace palpate::haptics
