// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "contacts/helper_elimination.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <set>
#include <tuple>
#include <utility>

#include "base/numbers.h"
#include "mesh/triangle_primitives.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Upper limit of the number of added helpers, in case the metric is so distorted that equal edges
/// remain.
constexpr int kMaxAdded = 2000;

/// A triangle of contacts is added at the rim of the contacts iff its largest angle is below this
/// [rad]; in flatter triangles weights would change from one contact to another over a small
/// height.
constexpr double kLargestRimAngle = 150 * std::numbers::pi / 180;

/// A tracked point becomes a helper iff none of its barycentric coordinates exceeds this.
constexpr double kLargestCoordinate = 0.9;

/// A triangle has an area iff its largest angle is below this [rad].
constexpr double kLargestAngle = 179.9 * std::numbers::pi / 180;

/// Neighbours are folded onto each other iff the cosine between their normals is at most this (150
/// degrees).
constexpr double kFoldedBack = -0.866;

bool is_edge(const IntrinsicTriangulation& surface, int h) {
  return surface.is_alive(h / 3) && surface.opposite(h) < h;
}

std::array<int, 3> ascending(std::array<int, 3> corners) {
  std::ranges::sort(corners);
  return corners;
}

/// Edges that violate a simplicial triangulation: loops, all but the shortest edge with the same
/// ends, and the first edge of a repeated triangle.
std::vector<int> ambiguous_edges(const IntrinsicTriangulation& surface) {
  std::vector<std::tuple<int, int, double, int>> edges;
  std::vector<std::pair<std::array<int, 3>, int>> triangles;
  for (int h = 0; h < 3 * surface.triangle_slots(); ++h) {
    if (!is_edge(surface, h)) continue;
    const auto [low, high] = std::minmax({surface.from(h), surface.to(h)});
    edges.emplace_back(low, high, surface.length(h), h);
  }
  std::vector<int> found;
  std::ranges::sort(edges);
  for (size_t i = 0; i < edges.size(); ++i) {
    const auto& [low, high, length, h] = edges[i];
    const bool repeats =
        i > 0 && std::get<0>(edges[i - 1]) == low && std::get<1>(edges[i - 1]) == high;
    if (low == high || repeats) found.push_back(h);
  }
  if (!found.empty()) return found;
  for (int t = 0; t < surface.triangle_slots(); ++t) {
    if (!surface.is_alive(t)) continue;
    triangles.emplace_back(
        ascending({surface.from(3 * t), surface.from(3 * t + 1), surface.from(3 * t + 2)}), 3 * t);
  }
  std::ranges::sort(triangles);
  for (size_t i = 1; i < triangles.size(); ++i) {
    if (triangles[i].first == triangles[i - 1].first) found.push_back(triangles[i].second);
  }
  return found;
}

/// The tracked point, in the two triangles at an edge, that is nearest to the edge's middle; kNone
/// if there is none within a quarter of the edge's length.
int point_near_middle(const IntrinsicTriangulation& surface, int edge) {
  int best = kNone;
  double nearest = kInfinity;
  for (const int h : {edge, surface.opposite(edge)}) {
    if (h == kNone) continue;
    const double l = surface.length(h);
    const double a = surface.length(IntrinsicTriangulation::previous(h));
    const double b = surface.length(IntrinsicTriangulation::next(h));
    const Vector2d apex = apex_of_lengths(l, a, b);
    const int k = h % 3;
    for (int id = surface.first_point(h / 3); id != kNone; id = surface.next_point(id)) {
      const Vector3d& at = surface.barycentric(id);
      const Vector2d place = at[(k + 1) % 3] * Vector2d(l, 0) + at[(k + 2) % 3] * apex;
      const double distance = (place - Vector2d(l / 2, 0)).squaredNorm();
      // A point at a corner would give an edge of zero length.
      const bool is_apart = at.maxCoeff() < kLargestCoordinate && distance < l * l / 16;
      if (!is_apart || !(std::tie(distance, id) < std::tie(nearest, best))) continue;
      nearest = distance;
      best = id;
    }
  }
  return best;
}

void push_star(const IntrinsicTriangulation& surface, int v, std::vector<int>& half_edges) {
  std::vector<int> fan;
  surface.fan(v, fan);
  for (const int h : fan) {
    const int t = h / 3;
    half_edges.insert(half_edges.end(), {3 * t, 3 * t + 1, 3 * t + 2});
  }
}

double angle_at_start(const IntrinsicTriangulation& surface, int h) {
  return angle_of_lengths(surface.length(h), surface.length(IntrinsicTriangulation::previous(h)),
                          surface.length(IntrinsicTriangulation::next(h)));
}

class EdgeTurning {
 public:
  EdgeTurning(IntrinsicTriangulation& surface, const std::vector<int>& contact_of_id)
      : surface_(surface), contact_of_id_(contact_of_id) {}

  void run() {
    turn_all([](double angle, int) { return angle < kLargestRimAngle; });
    // A contact that has no triangle yet also accepts flatter ones.
    turn_all([this](double, int corner) { return !has_triangle(corner); });
    std::vector<int> pending(static_cast<std::size_t>(3 * surface_.triangle_slots()));
    std::iota(pending.begin(), pending.end(), 0);
    surface_.flip_to_delaunay(pending, [this](int h) { return is_between_contacts(h); });
  }

 private:
  [[nodiscard]] bool is_contact(int v) const { return contact_of_id_[static_cast<size_t>(v)] >= 0; }
  [[nodiscard]] int helpers(int v, int w) const {
    return (is_contact(v) ? 0 : 1) + (is_contact(w) ? 0 : 1);
  }
  [[nodiscard]] bool is_of_contacts(int h) const {
    return helpers(surface_.from(h), surface_.to(h)) == 0 &&
           is_contact(surface_.from(IntrinsicTriangulation::previous(h)));
  }
  bool has_triangle(int v) {
    surface_.fan(v, fan_);
    return std::ranges::any_of(fan_, [this](int h) { return is_of_contacts(h); });
  }
  [[nodiscard]] bool is_between_contacts(int h) const {
    const int o = surface_.opposite(h);
    return is_of_contacts(h) && is_of_contacts(o) && !surface_.flip_repeats_edge(h);
  }

  /// Flips every edge that has more helpers at its ends than after the flip, until none is left;
  /// `is_welcome(angle, corner)` decides on a triangle of contacts with this angle.
  template <typename IsWelcome>
  void turn_all(const IsWelcome& is_welcome) {
    for (bool changed = true; changed;) {
      changed = false;
      for (int h = 0; h < 3 * surface_.triangle_slots(); ++h) {
        if (!is_edge(surface_, h) || surface_.opposite(h) == kNone) continue;
        const int o = surface_.opposite(h);
        const int c = surface_.from(IntrinsicTriangulation::previous(h));
        const int d = surface_.from(IntrinsicTriangulation::previous(o));
        const int before = helpers(surface_.from(h), surface_.to(h));
        if (helpers(c, d) >= before) continue;
        const auto welcome = [&](int corner, double angle) {
          return helpers(c, d) > 0 || !is_contact(corner) || is_welcome(angle, corner);
        };
        const double angle_a =
            angle_at_start(surface_, h) + angle_at_start(surface_, IntrinsicTriangulation::next(o));
        const double angle_b =
            angle_at_start(surface_, o) + angle_at_start(surface_, IntrinsicTriangulation::next(h));
        if (!welcome(surface_.from(h), angle_a) || !welcome(surface_.to(h), angle_b)) continue;
        if (surface_.flip_repeats_edge(h)) continue;
        changed = surface_.flip(h) || changed;
      }
    }
  }

  IntrinsicTriangulation& surface_;
  const std::vector<int>& contact_of_id_;
  std::vector<int> fan_;
};

/// A set of triangles of contacts in which every edge has at most one triangle on each side.
class ContactTriangles {
 public:
  explicit ContactTriangles(const Eigen::Matrix3Xd& places) : places_(places) {}

  [[nodiscard]] const std::vector<std::array<int, 3>>& triangles() const { return triangles_; }

  [[nodiscard]] bool fits(const std::array<int, 3>& corners) const {
    const auto& [a, b, c] = corners;
    if (a == b || b == c || c == a || known_.contains(ascending(corners))) return false;
    return !normal_of_side_.contains({a, b}) && !normal_of_side_.contains({b, c}) &&
           !normal_of_side_.contains({c, a});
  }

  /// Returns true if an angle exceeds the limit at the rim; a contact that has no triangle yet also
  /// accepts flatter ones.
  [[nodiscard]] bool is_too_flat(const std::array<int, 3>& corners, bool for_single) const {
    const bool is_single = std::ranges::any_of(corners, [&](int c) { return !used_.contains(c); });
    const double largest = for_single && is_single ? kLargestAngle : kLargestRimAngle;
    for (size_t k = 0; k < 3; ++k) {
      const Vector3d apex = places_.col(corners[k]);
      const Vector3d a = places_.col(corners[(k + 1) % 3]) - apex;
      const Vector3d b = places_.col(corners[(k + 2) % 3]) - apex;
      if (!(std::atan2(a.cross(b).norm(), a.dot(b)) < largest)) return true;
    }
    return false;
  }

  [[nodiscard]] bool folds_back(const std::array<int, 3>& corners) const {
    const Vector3d own = normal(corners);
    for (size_t k = 0; k < 3; ++k) {
      const auto across = normal_of_side_.find({corners[(k + 1) % 3], corners[k]});
      if (across != normal_of_side_.end() && !(own.dot(across->second) > kFoldedBack)) return true;
    }
    return false;
  }

  void add(const std::array<int, 3>& corners) {
    triangles_.push_back(corners);
    known_.insert(ascending(corners));
    used_.insert(corners.begin(), corners.end());
    for (size_t k = 0; k < 3; ++k) {
      normal_of_side_[{corners[k], corners[(k + 1) % 3]}] = normal(corners);
    }
  }

 private:
  [[nodiscard]] Vector3d normal(const std::array<int, 3>& corners) const {
    const Vector3d ab = places_.col(corners[1]) - places_.col(corners[0]);
    const Vector3d ac = places_.col(corners[2]) - places_.col(corners[0]);
    return ab.cross(ac).stableNormalized();
  }

  const Eigen::Matrix3Xd& places_;
  std::vector<std::array<int, 3>> triangles_;
  std::set<std::array<int, 3>> known_;  // corners in ascending order
  std::set<int> used_;                  // corners
  std::map<std::pair<int, int>, Vector3d> normal_of_side_;
};

}  // namespace

bool make_simplicial(IntrinsicTriangulation& surface,
                     const std::function<void(int id, int a, int b)>& add_position) {
  std::vector<int> pending;
  int allowed = kMaxAdded;
  while (allowed > 0) {
    const std::vector<int> edges = ambiguous_edges(surface);
    if (edges.empty()) return true;
    std::set<int> changed;  // triangles of this pass; their edges are visited in the next one
    for (const int h : edges) {
      const int o = surface.opposite(h);
      if (changed.contains(h / 3) || (o != kNone && changed.contains(o / 3))) continue;
      int id = point_near_middle(surface, h);
      if (id == kNone) {
        Vector3d middle = Vector3d::Zero();
        middle[h % 3] = middle[(h + 1) % 3] = 0.5;
        id = surface.track(h / 3, middle);
        add_position(id, surface.from(h), surface.to(h));
      }
      surface.make_vertex(id);
      --allowed;
      pending.clear();
      push_star(surface, id, pending);
      for (const int side : pending) changed.insert(side / 3);
      surface.flip_to_delaunay(pending, [&](int side) {
        changed.insert({side / 3, surface.opposite(side) / 3});
        return true;
      });
    }
  }
  return false;
}

void turn_edges_to_contacts(IntrinsicTriangulation& surface,
                            const std::vector<int>& contact_of_id) {
  EdgeTurning(surface, contact_of_id).run();
}

std::vector<std::array<int, 3>> triangles_of_contacts(const IntrinsicTriangulation& surface,
                                                      const std::vector<int>& contact_of_id,
                                                      const std::vector<WeightRow>& rows,
                                                      const Eigen::Matrix3Xd& places) {
  ContactTriangles result(places);
  std::vector<std::tuple<double, std::array<int, 3>>> candidates;
  for (int t = 0; t < surface.triangle_slots(); ++t) {
    if (!surface.is_alive(t)) continue;
    std::array<int, 3> corners{};
    bool is_own = true;
    for (int k = 0; k < 3; ++k) {
      const auto id = static_cast<size_t>(surface.from(3 * t + k));
      is_own = is_own && contact_of_id[id] >= 0;
      corners[static_cast<size_t>(k)] = rows[id].front().contact;
    }
    std::rotate(corners.begin(), std::ranges::min_element(corners), corners.end());
    if (is_own && result.fits(corners)) {
      result.add(corners);
    } else {
      candidates.emplace_back(
          surface.length(3 * t) + surface.length(3 * t + 1) + surface.length(3 * t + 2), corners);
    }
  }
  std::ranges::sort(candidates);
  for (const bool for_single : {false, true}) {
    for (const auto& [size, corners] : candidates) {
      if (!result.fits(corners) || result.is_too_flat(corners, for_single)) continue;
      if (!result.folds_back(corners)) result.add(corners);
    }
  }
  std::vector<std::array<int, 3>> triangles = result.triangles();
  std::ranges::sort(triangles);
  return triangles;
}

}  // namespace palpate::geometry
