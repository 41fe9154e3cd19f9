// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "measure.h"
#include "palpate/haptics/packed_field.h"
#include "tables.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;
using geometry::SurfacePoint;

constexpr double kOnCone = 1e-3;  // [N]

/// All places near a contact, tried one by one: knows nothing of how a contact moves.
class DenseSearch {
 public:
  explicit DenseSearch(const TouchedObject& object) : object_(object), field_(object.model) {}

  /// Finds a place within `reach` [mm] of a contact on the cone, and its `distance` [mm] from it.
  bool find(const Vector3d& tool, const Vector3d& contact, double reach, double& distance) {
    tool_ = tool;
    contact_ = contact;
    nearest_ = kInfinite;
    std::vector<std::pair<double, Vector3d>> middles;
    const Eigen::Matrix3Xi& triangles = object_.model.surface.triangles;
    for (int t = 0; t < triangles.cols(); ++t) {
      const SurfacePoint middle{t, Vector3d::Constant(1.0 / 3)};
      const Vector3d place = position(object_.model.surface, middle);
      if ((place - contact).norm() > reach) continue;
      middles.emplace_back(std::abs(excess(middle)), place);
      cross(t);
    }
    std::ranges::sort(middles, {}, [](const auto& m) { return m.first; });
    constexpr std::size_t kBest = 200;
    for (std::size_t i = 0; i < std::min(kBest, middles.size()); ++i) descend(middles[i].second);
    distance = nearest_;
    return nearest_ < kInfinite;
  }

 private:
  /// Infinite where the contact pulls.
  double excess(const SurfacePoint& at) {
    const Vector3d place = position(object_.model.surface, at);
    field_.move_to(at, place, field_at_);
    const haptics::FrictionParts parts =
        haptics::friction_parts(field_at_, field_.force(field_at_, tool_ - place).force);
    return parts.normal < 0 ? kInfinite : parts.excess;
  }
  void take(const SurfacePoint& at) {
    if (!(std::abs(excess(at)) <= kOnCone)) return;
    nearest_ = std::min(nearest_, (position(object_.model.surface, at) - contact_).norm());
  }
  /// Along rows of points of a triangle: bisects where the excess changes its sign.
  void cross(int t) {
    constexpr int kRows = 8, kHalvings = 40;
    for (int i = 0; i <= kRows; ++i) {
      SurfacePoint before{-1, {}};
      double excess_before = 0;
      for (int j = 0; i + j <= kRows; ++j) {
        const SurfacePoint here{t, Vector3d(i, j, kRows - i - j) / kRows};
        const double now = excess(here);
        if (before.triangle >= 0 && (now > 0) != (excess_before > 0)) {
          Vector3d low = before.barycentric, high = here.barycentric;
          for (int k = 0; k < kHalvings; ++k) {
            const Vector3d middle = (low + high) / 2;
            ((excess({t, middle}) > 0) == (excess_before > 0) ? low : high) = middle;
          }
          take({t, low});
        }
        before = here;
        excess_before = now;
      }
    }
  }
  /// Compass search: where there is no friction, the excess touches zero without a change of sign.
  void descend(const Vector3d& from) {
    constexpr double kFirst = 0.5, kLast = 1e-5;  // [mm]
    geometry::ClosestPoint at = object_.query.closest_point(from);
    double best = std::abs(excess(at.at));
    for (double step = kFirst; step > kLast && best > kOnCone / 2;) {
      bool better = false;
      for (int k = 0; k < 6 && !better; ++k) {
        const Vector3d way = (k % 2 == 0 ? step : -step) * Vector3d::Unit(k / 2);
        const geometry::ClosestPoint next = object_.query.closest_point(at.position + way);
        const double there = std::abs(excess(next.at));
        better = there < best;
        if (!better) continue;
        best = there;
        at = next;
      }
      if (!better) step /= 2;
    }
    take(at.at);
  }

  const TouchedObject& object_;
  haptics::PackedField field_;
  haptics::PlaceField field_at_;
  Vector3d tool_, contact_;
  double nearest_ = kInfinite;
};

}  // namespace

void print_missed_slips(int jumps) {
  constexpr double kDepth = 3, kReach = 13;  // [mm]
  fmt::print(
      "\n| object | friction | jump [mm] | slips; contacts that end | beyond 1 mN | inside the "
      "cone "
      "| no place on the cone | one elsewhere; [mm] from the start | farthest result from the "
      "border "
      "[mm] |\n|---|---|---|---|---|---|---|---|---|\n");
  for (const double friction : {0.0, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 3.0}) {
    std::vector<TouchedObject> objects;
    objects.push_back(hills(friction));
    objects.push_back(hand(friction));
    for (const TouchedObject& object : objects) {
      const haptics::Playback playback(object.model, unlimited({.energy_credit = kInfinite}));
      DenseSearch search(object);
      for (const double jump : {0.3, 2.0, 10.0}) {
        std::mt19937 random(7);
        int slips = 0, ended = 0, beyond = 0, inside = 0, none = 0;
        double to_border = 0;
        std::vector<double> elsewhere;
        for (int i = 0; i < jumps; ++i) {
          const PressPlace at = press_place(object, random);
          haptics::LoopState state;
          static_cast<void>(playback.step(at.position + at.normal, state));
          const Vector3d pressed = at.position - kDepth * at.normal;
          const Vector3d start = playback.step(pressed, state).contact;
          const Vector3d tool = pressed + jump * at.along;
          const haptics::Command command = playback.step(tool, state);
          ended += command.state == haptics::ContactState::free;
          if (command.state != haptics::ContactState::slip) continue;
          ++slips;
          if (residual(state, command) <= kOnCone) continue;
          ++beyond;
          to_border = std::max(to_border, object.to_border(command.contact));
          double distance = 0;
          if (haptics::friction_parts(state.place, -command.force).excess < 0) {
            ++inside;
          } else if (!search.find(tool, start, jump + kReach, distance)) {
            ++none;
          } else {
            elsewhere.push_back(distance);
          }
        }
        if (beyond == 0) continue;
        fmt::print("| {} | {} | {} | {}; {} | {} | {} | {} | {}; {:.1f} to {:.1f} | {:.2g} |\n",
                   object.name, friction, jump, slips, ended, beyond, inside, none,
                   elsewhere.size(), quantile(elsewhere, 0), quantile(elsewhere, 1), to_border);
        std::fflush(stdout);
      }
    }
  }
}

}  // namespace palpate::bench
