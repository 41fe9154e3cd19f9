// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Segments that cross a surface tree.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <utility>
#include <vector>

#include "base/numbers.h"
#include "query/surface_tree.h"
#include "query/tree_walk.h"
#include "query/triangle_packet.h"

namespace palpate::geometry {
namespace {

/// Few lines cross a surface more often, so that memory for the crossings is allocated only once.
constexpr std::size_t kUsualCrossings = 8;

/// A segment in float that meets the side of a box at the fraction (side - origin) * inverse of its
/// length.
struct SlabSegment {
  std::array<BoxLanes, 3> origin, inverse;
  std::array<std::size_t, 3> near_side;  ///< index of the side where it enters a box

  SlabSegment(const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
    // A segment parallel to a side of a box is tilted by less than its rounding.
    constexpr float kLeast = 1e-18F;
    for (std::size_t k = 0; k < 3; ++k) {
      const auto axis = static_cast<int>(k);
      const auto along = static_cast<float>(end[axis] - start[axis]);
      near_side[k] = std::signbit(along) ? 1 : 0;
      origin[k] = BoxLanes::Constant(static_cast<float>(start[axis]));
      inverse[k] = BoxLanes::Constant(1 / std::copysign(std::max(std::abs(along), kLeast), along));
    }
  }
  /// Finds the boxes that it enters before `far`, and where.
  [[nodiscard]] unsigned meet(const TreeNode& node, float far, BoxLanes& enter) const {
    enter = BoxLanes::Zero();
    BoxLanes leave = BoxLanes::Constant(far);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const std::array<BoxLanes, 2>& sides = node.sides[axis];
      enter = enter.max((sides[near_side[axis]] - origin[axis]) * inverse[axis]);
      leave = leave.min((sides[1 - near_side[axis]] - origin[axis]) * inverse[axis]);
    }
    return where_not_above(enter, leave);
  }
};

}  // namespace

/// The packet with this number; begins to load the exact corners of its triangles too.
const TrianglePacket& SurfaceTree::start_packet(int number) const {
  const auto packet = static_cast<std::size_t>(number);
  if (!corners_.empty()) load(&corners_[packet * TrianglePacket::kSize], TrianglePacket::kSize);
  return tree_.packets[packet];
}

/// State of a segment query.
struct SurfaceTree::CrossingSearch {
  const Eigen::Vector3d &start, &end;
  ShearedSegment segment;
  SegmentLanes lanes;
  float length;              ///< along the main axis
  float far = 1;             ///< fraction of the segment up to which crossings matter
  CrossedTriangle best;      ///< between the ends
  NearestTriangle at_start;  ///< triangles on which an end lies
  NearestTriangle at_end;

  CrossingSearch(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double margin)
      : start(from),
        end(to),
        segment(from, to),
        lanes(from, segment, margin),
        length(static_cast<float>(std::abs(segment.length()))) {}
};

/// Keeps the triangle if it is the nearest to `end` of those that touch it.
void SurfaceTree::touch(NearestTriangle& nearest, const Eigen::Vector3d& end, int triangle,
                        int place) const {
  const Nearest candidate = nearest_on_triangle(end, local_corners(place));
  if (std::sqrt(candidate.squared_distance) <= on_surface_ &&
      improves(candidate.squared_distance, triangle, nearest.at.squared_distance,
               nearest.triangle)) {
    nearest = {.at = candidate, .triangle = triangle, .place = place};
  }
}

void SurfaceTree::look_at(CrossingSearch& search, int number) const {
  const TrianglePacket& packet = start_packet(number);
  const float margin = search.lanes.margin();
  const Passing passing = search.lanes.pass(packet);
  const Lanes away = passing.miss.max(-margin - passing.end)
                         .max(passing.begin - (search.far * search.length + margin));
  unsigned bits = where_not_above(away, Lanes::Zero());
  for (; bits != 0; bits &= bits - 1) {
    const int lane = std::countr_zero(bits);
    const int triangle = packet.triangle[static_cast<std::size_t>(lane)];
    if (triangle < 0) continue;
    const int place = TrianglePacket::kSize * number + lane;
    const Crossing candidate = cross_triangle(search.segment, local_corners(place));
    if (improves(candidate.fraction, triangle, search.best.at.fraction, search.best.triangle)) {
      search.best = {.at = candidate, .triangle = triangle, .place = place};
      search.far = std::min(search.far, round_up(candidate.fraction));
    }
    if (passing.begin[lane] <= margin) touch(search.at_start, search.start, triangle, place);
    if (passing.end[lane] >= search.length - margin)
      touch(search.at_end, search.end, triangle, place);
  }
}

CrossedTriangle SurfaceTree::first_crossing(const Eigen::Vector3d& start,
                                            const Eigen::Vector3d& end) const noexcept {
  if (start == end) {
    const NearestTriangle touched = nearest(start, on_surface_);
    if (std::sqrt(touched.at.squared_distance) > on_surface_) return {};
    return {
        {.fraction = 0, .barycentric = touched.at.barycentric}, touched.triangle, touched.place};
  }
  const SlabSegment slabs(start, end);
  CrossingSearch search(start, end, margin_);
  walk_tree<float>(
      tree_,
      [&](const TreeNode& node, BoxLanes& enter) { return slabs.meet(node, search.far, enter); },
      [&](int packet) { look_at(search, packet); }, [&] { return search.far; });
  if (search.at_start.triangle >= 0) {
    return {{.fraction = 0, .barycentric = search.at_start.at.barycentric},
            search.at_start.triangle,
            search.at_start.place};
  }
  if (search.best.triangle < 0 && search.at_end.triangle >= 0) {
    return {{.fraction = 1, .barycentric = search.at_end.at.barycentric},
            search.at_end.triangle,
            search.at_end.place};
  }
  return search.best;
}

bool SurfaceTree::touches(const Eigen::Vector3d& end, int place) const {
  return std::sqrt(nearest_on_triangle(end, local_corners(place)).squared_distance) <= on_surface_;
}

std::vector<CrossedTriangle> SurfaceTree::all_crossings(const Eigen::Vector3d& start,
                                                        const Eigen::Vector3d& end) const {
  std::vector<CrossedTriangle> crossings;
  if (start == end) {
    const CrossedTriangle touched = first_crossing(start, end);
    if (touched.triangle >= 0) crossings.push_back(touched);
    return crossings;
  }
  const SlabSegment slabs(start, end);
  const ShearedSegment segment(start, end);
  const SegmentLanes lanes(start, segment, margin_);
  const auto length = static_cast<float>(std::abs(segment.length()));
  const auto look_at = [&](int number) {
    const TrianglePacket& packet = start_packet(number);
    const Passing passing = lanes.pass(packet);
    const Lanes away = passing.miss.max(-lanes.margin() - passing.end)
                           .max(passing.begin - (length + lanes.margin()));
    for (unsigned bits = where_not_above(away, Lanes::Zero()); bits != 0; bits &= bits - 1) {
      const int lane = std::countr_zero(bits);
      const int triangle = packet.triangle[static_cast<std::size_t>(lane)];
      if (triangle < 0) continue;
      const int place = TrianglePacket::kSize * number + lane;
      Crossing crossing = cross_triangle_beside_edges(segment, local_corners(place));
      if (!(std::abs(crossing.fraction) < kInfinity)) continue;
      if (crossing.fraction < 0) {
        if (!touches(start, place)) continue;
        crossing.fraction = 0;
      } else if (crossing.fraction > 1) {
        if (!touches(end, place)) continue;
        crossing.fraction = 1;
      }
      if (crossings.empty()) crossings.reserve(kUsualCrossings);
      crossings.push_back({.at = crossing, .triangle = triangle, .place = place});
    }
  };
  walk_tree<float>(
      tree_, [&](const TreeNode& node, BoxLanes& enter) { return slabs.meet(node, 1, enter); },
      look_at, [] { return 1.0F; });
  const auto place = [](const CrossedTriangle& one) {
    return std::pair(one.at.fraction, one.triangle);
  };
  std::sort(crossings.begin(), crossings.end(),
            [&](const auto& a, const auto& b) { return place(a) < place(b); });
  return crossings;
}

}  // namespace palpate::geometry
