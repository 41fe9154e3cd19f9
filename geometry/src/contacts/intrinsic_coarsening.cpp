// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "contacts/intrinsic_coarsening.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "mesh/triangle_primitives.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector2d;

/// A vertex is flat iff its angles sum to 2 pi (pi at the border) within this [rad]: the rounding
/// of some tens of angles.
constexpr double kFlat = 1e-11;

/// Margin of a flattened vertex's triangles from zero area, as a fraction of their squared sides.
constexpr double kTriangleMargin = 1e-9;

/// Vertices removed between two reports.
constexpr int kReport = 1000;

/// Newton's method with bisection at least halves its bracket.
constexpr int kMaxIterations = 60;

/// The triangles around a vertex: each has two spokes, and a link opposite to the vertex.
struct Star {
  std::vector<int> half_edges;  ///< leaving the vertex, counter-clockwise
  std::vector<double> spokes;   ///< one more than triangles at the border
  std::vector<double> links;
  double full_angle = 0;  ///< sum of its angles when flat

  [[nodiscard]] double spoke(size_t i) const { return spokes[i % spokes.size()]; }
};

void read_star(const IntrinsicTriangulation& surface, int v, Star& star) {
  surface.fan(v, star.half_edges);
  star.spokes.clear();
  star.links.clear();
  for (const int h : star.half_edges) {
    star.spokes.push_back(surface.length(h));
    star.links.push_back(surface.length(IntrinsicTriangulation::next(h)));
  }
  star.full_angle = 2 * std::numbers::pi;
  if (surface.is_boundary(v)) {
    star.full_angle = std::numbers::pi;
    star.spokes.push_back(surface.length(IntrinsicTriangulation::previous(star.half_edges.back())));
  }
}

double angle_sum(const Star& star, double stretch) {
  double sum = 0;
  for (size_t i = 0; i < star.links.size(); ++i) {
    sum += angle_of_lengths(star.spoke(i), star.spoke(i + 1), star.links[i] * stretch);
  }
  return sum;
}

/// Factor by which all links must be stretched (or the spokes shortened) to make the vertex flat;
/// none if this would give a triangle without area.
std::optional<double> flattening_stretch(const Star& star) {
  double low = 0;
  double high = std::numeric_limits<double>::infinity();
  for (size_t i = 0; i < star.links.size(); ++i) {
    const double a = star.spoke(i);
    const double b = star.spoke(i + 1);
    low = std::max(low, std::abs(a - b) / star.links[i]);
    high = std::min(high, (a + b) / star.links[i]);
  }
  low *= 1 + kTriangleMargin;
  high *= 1 - kTriangleMargin;
  double stretch = 1;
  for (int i = 0; i < kMaxIterations; ++i) {
    const double excess = angle_sum(star, stretch) - star.full_angle;
    if (std::abs(excess) <= kFlat) return stretch;
    // The sum of angles grows with the stretch.
    (excess > 0 ? high : low) = stretch;
    double slope = 0;
    for (size_t k = 0; k < star.links.size(); ++k) {
      const double link = star.links[k] * stretch;
      const double area = area_of_lengths(star.spoke(k), star.spoke(k + 1), link);
      slope += link * star.links[k] / (2 * area);
    }
    stretch -= excess / slope;
    if (!(stretch > low && stretch < high)) stretch = (low + high) / 2;
    if (!(high - low > kTriangleMargin * low)) break;
  }
  return std::nullopt;
}

class Coarsening {
 public:
  Coarsening(IntrinsicTriangulation& surface, WorkSteps& steps)
      : surface_(surface), steps_(steps) {}

  void run(const std::vector<char>& pinned) {
    push_all();
    flip_without_repeats();
    std::vector<int> candidates;
    for (int v = 0; v < surface_.id_count(); ++v) {
      if (surface_.is_vertex(v) && pinned[static_cast<size_t>(v)] == 0) candidates.push_back(v);
    }
    last_change_.assign(static_cast<size_t>(surface_.id_count()), -1);
    bool all_allowed = false;
    for (int round = 0; !candidates.empty(); ++round) {
      const size_t before = candidates.size();
      remove_round(candidates, round, all_allowed);
      if (candidates.size() == before && all_allowed) break;
      all_allowed = candidates.size() == before;
    }
    push_all();
    surface_.flip_to_delaunay(pending_);
  }

 private:
  void push_all() {
    for (int t = 0; t < surface_.triangle_slots(); ++t) {
      if (surface_.is_alive(t)) pending_.insert(pending_.end(), {3 * t, 3 * t + 1, 3 * t + 2});
    }
  }

  void flip_without_repeats() {
    surface_.flip_to_delaunay(pending_, [this](int h) { return !surface_.flip_repeats_edge(h); });
  }

  /// The flatter half of the vertices, without neighbours among them, so that the effect of one
  /// removal on its neighbours is known before they are removed.
  void remove_round(std::vector<int>& candidates, int round, bool all_allowed) {
    costs_.clear();
    for (const int v : candidates) {
      read_star(surface_, v, star_);
      costs_.push_back(std::abs(angle_sum(star_, 1) - star_.full_angle));
    }
    double limit = std::numeric_limits<double>::infinity();
    if (!all_allowed) {
      sorted_ = costs_;
      const auto middle = sorted_.begin() + static_cast<std::ptrdiff_t>(sorted_.size() / 2);
      std::nth_element(sorted_.begin(), middle, sorted_.end());
      limit = *middle;
    }
    size_t kept = 0;
    int removed = 0;
    for (size_t i = 0; i < candidates.size(); ++i) {
      const int v = candidates[i];
      const bool wait = last_change_[static_cast<size_t>(v)] == round || !(costs_[i] <= limit);
      if (wait || !remove(v)) {
        candidates[kept++] = v;
        continue;
      }
      for (size_t n = 0; n + 1 < patch_.nodes.size(); ++n) {
        last_change_[static_cast<size_t>(patch_.nodes[n].vertex)] = round;
      }
      if (++removed % kReport == 0) steps_.tell(kReport);
    }
    steps_.tell(removed % kReport);
    candidates.resize(kept);
  }

  bool remove(int v) {
    pending_.clear();
    const bool removed = open_star(v) && lay_out(v) && triangulate_polygon(surface_.is_boundary(v));
    if (removed) {
      surface_.replace(patch_);
      surface_.retire_vertex(v, patch_);
      for (const int t : patch_.new_triangles) {
        pending_.insert(pending_.end(), {3 * t, 3 * t + 1, 3 * t + 2});
      }
    }
    flip_without_repeats();
    return removed;
  }

  /// Reads the star. A border vertex with only one triangle is given a second one first.
  bool open_star(int v) {
    read_star(surface_, v, star_);
    if (star_.half_edges.size() > 1 || !surface_.is_boundary(v)) return true;
    const int link = IntrinsicTriangulation::next(star_.half_edges.front());
    const int other = surface_.opposite(link);
    if (other == kNone || surface_.flip_repeats_edge(link)) return false;
    if (!surface_.flip(link)) return false;
    for (const int t : {link / 3, other / 3}) {
      pending_.insert(pending_.end(), {3 * t, 3 * t + 1, 3 * t + 2});
    }
    read_star(surface_, v, star_);
    return true;
  }

  /// The flattened star in the plane, the vertex at the origin.
  bool lay_out(int v) {
    const std::optional<double> stretch = flattening_stretch(star_);
    if (!stretch) return false;
    patch_.nodes.clear();
    patch_.old_triangles.clear();
    patch_.old_nodes.clear();
    const auto rim = static_cast<int>(star_.spokes.size());
    double direction = 0;
    for (size_t i = 0; i < star_.half_edges.size(); ++i) {
      const int h = star_.half_edges[i];
      const double radius = star_.spokes[i] / *stretch;
      patch_.nodes.push_back(
          {.vertex = surface_.to(h),
           .position = {radius * std::cos(direction), radius * std::sin(direction)}});
      direction += angle_of_lengths(star_.spoke(i), star_.spoke(i + 1), star_.links[i] * *stretch);
      IntrinsicTriangulation::Patch::Triangle nodes{};
      const auto n = static_cast<int>(i);
      nodes[static_cast<size_t>(h % 3)] = rim;
      nodes[static_cast<size_t>((h + 1) % 3)] = n;
      nodes[static_cast<size_t>((h + 2) % 3)] = (n + 1) % rim;
      patch_.old_triangles.push_back(h / 3);
      patch_.old_nodes.push_back(nodes);
    }
    if (surface_.is_boundary(v)) {
      const int last = IntrinsicTriangulation::previous(star_.half_edges.back());
      patch_.nodes.push_back(
          {.vertex = surface_.from(last), .position = {-star_.spokes.back() / *stretch, 0}});
    }
    patch_.nodes.push_back({.vertex = v, .position = {0, 0}});
    return rim >= 3;
  }

  /// Cuts ears off the polygon around the origin until a triangle is left, starting with the ear
  /// whose circumcircle extends least beyond the origin. If the star is Delaunay, so is the result
  /// (Devillers 1999).
  bool triangulate_polygon(bool at_border) {
    patch_.new_nodes.clear();
    ring_.clear();
    for (int n = 0; n + 1 < static_cast<int>(patch_.nodes.size()); ++n) ring_.push_back(n);
    const auto at = [this](size_t i) -> const Vector2d& {
      return patch_.nodes[static_cast<size_t>(ring_[i % ring_.size()])].position;
    };
    if (at_border && are_joined(ring_.front(), ring_.back())) return false;
    if (ring_.size() == 3 && !at_border && is_closed_by_one_triangle()) return false;
    while (ring_.size() > 3) {
      double best_power = std::numeric_limits<double>::infinity();
      size_t best = ring_.size();
      for (size_t i = 0; i < ring_.size(); ++i) {
        const Vector2d& p = at(i + ring_.size() - 1);
        const Vector2d& q = at(i);
        const Vector2d& r = at(i + 1);
        const double area = cross(q - p, r - q);
        if (!(area > 0) || cross(p, r) < -kTriangleMargin * area) continue;
        const double power = (p.squaredNorm() * cross(q, r) + q.squaredNorm() * cross(r, p) +
                              r.squaredNorm() * cross(p, q)) /
                             area;
        if (!(power < best_power)) continue;
        if (are_joined(ring_[(i + ring_.size() - 1) % ring_.size()],
                       ring_[(i + 1) % ring_.size()])) {
          continue;
        }
        best_power = power;
        best = i;
      }
      if (best == ring_.size()) return false;
      patch_.new_nodes.push_back({ring_[(best + ring_.size() - 1) % ring_.size()], ring_[best],
                                  ring_[(best + 1) % ring_.size()]});
      ring_.erase(ring_.begin() + static_cast<std::ptrdiff_t>(best));
    }
    patch_.new_nodes.push_back({ring_[0], ring_[1], ring_[2]});
    return cross(at(1) - at(0), at(2) - at(1)) > 0;
  }

  [[nodiscard]] bool are_joined(int node, int other) const {
    const int a = patch_.nodes[static_cast<size_t>(node)].vertex;
    const int b = patch_.nodes[static_cast<size_t>(other)].vertex;
    return a == b || surface_.are_joined(a, b);
  }

  /// Returns true if the three links of the star border the same triangle, which with the star
  /// forms a closed surface.
  [[nodiscard]] bool is_closed_by_one_triangle() const {
    std::array<int, 3> across{};
    for (size_t i = 0; i < 3; ++i) {
      const int o = surface_.opposite(IntrinsicTriangulation::next(star_.half_edges[i]));
      across[i] = o == kNone ? -1 - static_cast<int>(i) : o / 3;
    }
    return across[0] == across[1] || across[1] == across[2] || across[2] == across[0];
  }

  IntrinsicTriangulation& surface_;
  WorkSteps& steps_;
  Star star_;
  IntrinsicTriangulation::Patch patch_;
  std::vector<int> ring_;
  std::vector<int> pending_;
  std::vector<int> last_change_;  ///< the last round in which a removal affected the vertex
  std::vector<double> costs_;
  std::vector<double> sorted_;
};

}  // namespace

void coarsen(IntrinsicTriangulation& surface, const std::vector<char>& pinned, WorkSteps& steps) {
  Coarsening(surface, steps).run(pinned);
}

}  // namespace palpate::geometry
