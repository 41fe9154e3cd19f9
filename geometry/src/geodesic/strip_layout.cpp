// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/strip_layout.h"

#include <array>

#include "mesh/triangle_primitives.h"

namespace palpate::geometry {
namespace {

Eigen::Vector2d to_left_of(const Eigen::Vector2d& direction) {
  return {-direction.y(), direction.x()};
}

/// A triangle in the plane. Directions are kept apart from positions, because those of short edges
/// would be lost in the rounding of positions.
struct PlacedTriangle {
  std::array<Eigen::Vector2d, 3> corners;
  std::array<Eigen::Vector2d, 3> directions;  ///< unit, of the half-edges
};

PlacedTriangle place(const FlatTriangles& flat, int half_edge, const Eigen::Vector2d& start,
                     const Eigen::Vector2d& end, const Eigen::Vector2d& direction) {
  const FlatHalfEdge& base = flat[half_edge];
  const int next = next_half_edge(half_edge);
  const int last = last_half_edge(half_edge);
  const Eigen::Vector2d above = to_left_of(direction);
  const Eigen::Vector2d from_end = base.right.y() * above - base.right.x() * direction;
  const Eigen::Vector2d from_start = base.left.y() * above + base.left.x() * direction;
  PlacedTriangle placed;
  placed.corners[static_cast<size_t>(half_edge % 3)] = start;
  placed.corners[static_cast<size_t>(next % 3)] = end;
  placed.corners[static_cast<size_t>(last % 3)] = flat[last].length < flat[next].length
                                                      ? start + flat[last].length * from_start
                                                      : end + flat[next].length * from_end;
  placed.directions[static_cast<size_t>(half_edge % 3)] = direction;
  placed.directions[static_cast<size_t>(next % 3)] = from_end;
  placed.directions[static_cast<size_t>(last % 3)] = -from_start;
  return placed;
}

Eigen::Vector2d position_in(const PlacedTriangle& placed, const SurfacePoint& point) {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();
  for (size_t k = 0; k < 3; ++k)
    at += point.barycentric[static_cast<Eigen::Index>(k)] * placed.corners[k];
  return at;
}

/// The shortest path in a strip, while its portals are passed one after the other.
class Funnel {
 public:
  explicit Funnel(const StripLayout& layout) : layout_(layout), apex_(layout.from) {}

  std::vector<StripBend> run() {
    const auto count = static_cast<int>(layout_.portals.size());
    int portal = 0;
    while (portal <= count) {
      const bool is_end = portal == count;
      const auto i = static_cast<size_t>(portal);
      const Eigen::Vector2d& right = is_end ? layout_.to : layout_.portals[i].right;
      const Eigen::Vector2d& left = is_end ? layout_.to : layout_.portals[i].left;
      if (is_new_) {
        right_ = right;
        left_ = left;
        right_portal_ = left_portal_ = portal;
        is_new_ = false;
      } else if (crosses(right, true)) {
        portal = bend(left_portal_, true);
        continue;
      } else if (crosses(left, false)) {
        portal = bend(right_portal_, false);
        continue;
      } else {
        narrow(right, left, portal);
      }
      ++portal;
    }
    return std::move(bends_);
  }

 private:
  /// Returns true if a point is beyond the left (or right) side of the funnel.
  [[nodiscard]] bool crosses(const Eigen::Vector2d& point, bool left_side) const {
    const Eigen::Vector2d side = (left_side ? left_ : right_) - apex_;
    const double turn = cross(side, point - apex_);
    return left_side ? turn > 0 : turn < 0;
  }

  void narrow(const Eigen::Vector2d& right, const Eigen::Vector2d& left, int portal) {
    if (cross(right_ - apex_, right - apex_) >= 0) {
      right_ = right;
      right_portal_ = portal;
    }
    if (cross(left_ - apex_, left - apex_) <= 0) {
      left_ = left;
      left_portal_ = portal;
    }
  }

  /// Bends at one end of a portal. \return the portal to go on with
  int bend(int portal, bool is_left) {
    bends_.push_back(bend_at(layout_, portal, is_left));
    apex_ = bends_.back().at;
    is_new_ = true;
    return bends_.back().last + 1;
  }

  const StripLayout& layout_;
  std::vector<StripBend> bends_;
  Eigen::Vector2d apex_;
  Eigen::Vector2d right_, left_;  ///< points on the sides of the funnel
  int right_portal_ = 0, left_portal_ = 0;
  bool is_new_ = true;
};

}  // namespace

StripLayout lay_out(const FlatTriangles& flat, const TriangleStrip& strip) {
  StripLayout layout;
  const int base = 3 * strip.from.triangle;
  PlacedTriangle placed = place(flat, base, Eigen::Vector2d::Zero(),
                                Eigen::Vector2d(flat[base].length, 0), Eigen::Vector2d::UnitX());
  layout.from = position_in(placed, strip.from);
  layout.portals.reserve(strip.crossed.size());
  for (const int h : strip.crossed) {
    const auto k = static_cast<size_t>(h % 3);
    const Portal portal{.right = placed.corners[k],
                        .left = placed.corners[(k + 1) % 3],
                        .direction = placed.directions[k],
                        .right_vertex = flat[h].start,
                        .left_vertex = flat[next_half_edge(h)].start};
    layout.portals.push_back(portal);
    placed = place(flat, flat[h].opposite, portal.left, portal.right, -portal.direction);
  }
  layout.to = position_in(placed, strip.to);
  return layout;
}

StripBend bend_at(const StripLayout& layout, int portal, bool is_left) {
  const auto at = [&](int i) -> const Portal& { return layout.portals[static_cast<size_t>(i)]; };
  const int vertex = at(portal).vertex(is_left);
  StripBend bend{
      .at = at(portal).end(is_left), .is_left = is_left, .first = portal, .last = portal};
  const auto count = static_cast<int>(layout.portals.size());
  while (bend.first > 0 && at(bend.first - 1).vertex(is_left) == vertex) --bend.first;
  while (bend.last + 1 < count && at(bend.last + 1).vertex(is_left) == vertex) ++bend.last;
  return bend;
}

std::vector<StripBend> funnel(const StripLayout& layout) { return Funnel(layout).run(); }

}  // namespace palpate::geometry
