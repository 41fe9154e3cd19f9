// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/straight_strip.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "base/numbers.h"
#include "geodesic/strip_layout.h"
#include "mesh/triangle_primitives.h"

namespace palpate::geometry {
namespace {

/// [rad] An angle is straight within this, far above the rounding of a sum of angles; at most the
/// square of it is left to gain at a vertex, relative to the length.
constexpr double kStraight = 1e-9;

/// A path touches a vertex iff it crosses an edge within this fraction of the edge from it.
constexpr double kTouches = 1e-12;

/// The path no longer gets shorter once this number of attempts has not shortened it by more than
/// rounding.
constexpr int kMostIdle = 8;
constexpr double kShorter = 1e-15;

/// The shortest path in a strip: how it crosses each portal.
struct Crossings {
  StripLayout layout;
  std::vector<StripBend> bends;
  std::vector<double> share;  ///< of each portal: where it is crossed, 0 at its right end
  std::vector<int> segment;   ///< of each portal: the number of bends before it
  double length = 0;

  [[nodiscard]] const Eigen::Vector2d& before(int s) const {
    return s == 0 ? layout.from : bends[static_cast<size_t>(s) - 1].at;
  }
  [[nodiscard]] const Eigen::Vector2d& after(int s) const {
    return s == static_cast<int>(bends.size()) ? layout.to : bends[static_cast<size_t>(s)].at;
  }
};

double share_of(const Portal& portal, const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  const double right = -cross(to - from, portal.right - from);
  const double left = cross(to - from, portal.left - from);
  if (!(right > 0)) return 0;
  if (!(left > 0)) return 1;
  const double share = right / (right + left);
  if (share < kTouches) return 0;
  return share > 1 - kTouches ? 1 : share;
}

Crossings cross_strip(const FlatTriangles& flat, const TriangleStrip& strip) {
  Crossings crossings{.layout = lay_out(flat, strip), .bends = {}, .share = {}, .segment = {}};
  crossings.bends = funnel(crossings.layout);
  const auto bend_count = static_cast<int>(crossings.bends.size());
  int segment = 0;
  for (int p = 0; p < static_cast<int>(strip.crossed.size()); ++p) {
    while (segment < bend_count && crossings.bends[static_cast<size_t>(segment)].last < p)
      ++segment;
    const bool is_at_bend =
        segment < bend_count && crossings.bends[static_cast<size_t>(segment)].first <= p;
    const Portal& portal = crossings.layout.portals[static_cast<size_t>(p)];
    crossings.segment.push_back(segment);
    crossings.share.push_back(
        is_at_bend ? (crossings.bends[static_cast<size_t>(segment)].is_left ? 1 : 0)
                   : share_of(portal, crossings.before(segment), crossings.after(segment)));
  }
  for (int s = 0; s <= bend_count; ++s)
    crossings.length += (crossings.after(s) - crossings.before(s)).norm();
  return crossings;
}

double plane_angle(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::atan2(std::abs(cross(a, b)), a.dot(b));
}

/// The angle of a triangle at the start of a half-edge.
double corner_angle(const FlatTriangles& flat, int h) {
  return std::atan2(flat[h].left.y(), flat[h].left.x());
}

/// The angle at a vertex that the path touches, on the side of the strip.
double strip_angle(const FlatTriangles& flat, const TriangleStrip& strip,
                   const Crossings& crossings, const StripBend& bend) {
  const int first_segment = crossings.segment[static_cast<size_t>(bend.first)];
  const int last_segment = crossings.segment[static_cast<size_t>(bend.last)];
  const auto is_this_bend = [&](int segment) {
    if (segment >= static_cast<int>(crossings.bends.size())) return false;
    const StripBend& other = crossings.bends[static_cast<size_t>(segment)];
    return other.is_left == bend.is_left && other.first == bend.first;
  };
  const Eigen::Vector2d& from = crossings.before(first_segment);
  const Eigen::Vector2d& to =
      crossings.after(is_this_bend(last_segment) ? last_segment + 1 : last_segment);
  const double sign = bend.is_left ? -1 : 1;
  const auto along = [&](int p) -> Eigen::Vector2d {
    return sign * crossings.layout.portals[static_cast<size_t>(p)].direction;
  };
  double angle =
      plane_angle(from - bend.at, along(bend.first)) + plane_angle(along(bend.last), to - bend.at);
  for (int p = bend.first; p < bend.last; ++p) {
    const int entered = flat[strip.crossed[static_cast<size_t>(p)]].opposite;
    angle += corner_angle(flat, bend.is_left ? entered : next_half_edge(entered));
  }
  return angle;
}

/// The half-edges to cross on the other side of a vertex instead of those of a bend, if the vertex
/// is not on the border and the angle there is less than a straight one.
std::optional<std::vector<int>> shorter_way(const FlatTriangles& flat, const TriangleStrip& strip,
                                            const Crossings& crossings, const StripBend& bend) {
  const int entry = strip.crossed[static_cast<size_t>(bend.first)];
  const int passed = bend.last - bend.first + 1;
  double angle = 0;
  std::vector<int> turn;  // all half-edges round the vertex, backwards
  int h = bend.is_left ? next_half_edge(entry) : entry;
  const int first = h;
  do {
    angle += corner_angle(flat, h);
    const int through = bend.is_left ? h : last_half_edge(h);
    const int across = flat[through].opposite;
    if (across == kNone) return std::nullopt;
    turn.push_back(through);
    h = bend.is_left ? next_half_edge(across) : across;
  } while (h != first);
  angle -= strip_angle(flat, strip, crossings, bend);
  if (!(angle < std::numbers::pi - kStraight)) return std::nullopt;
  const auto degree = static_cast<int>(turn.size());
  if (passed >= degree) {
    const auto begin = strip.crossed.begin() + bend.first;
    return std::vector<int>(begin, begin + passed - degree);
  }
  turn.resize(static_cast<size_t>(degree - passed));
  return turn;
}

/// The shorter way round a vertex that the path touches and at which this portal is the first.
struct Detour {
  StripBend bend;
  std::vector<int> crossed;
};
std::optional<Detour> detour_at(const FlatTriangles& flat, const TriangleStrip& strip,
                                const Crossings& crossings, int portal) {
  for (const bool is_left : {false, true}) {
    const StripBend bend = bend_at(crossings.layout, portal, is_left);
    if (bend.first != portal) continue;
    const auto begin = crossings.share.begin() + bend.first;
    const auto end = crossings.share.begin() + bend.last + 1;
    if (std::find(begin, end, is_left ? 1.0 : 0.0) == end) continue;
    std::optional<std::vector<int>> way = shorter_way(flat, strip, crossings, bend);
    if (way) return Detour{bend, std::move(*way)};
  }
  return std::nullopt;
}

/// Leads the strip round the other side of each vertex where this is shorter.
/// \return none if there is no such vertex
std::optional<TriangleStrip> shorter_strip(const FlatTriangles& flat, const TriangleStrip& strip,
                                           const Crossings& crossings) {
  TriangleStrip shorter{.from = strip.from, .crossed = {}, .to = strip.to};
  bool is_other = false;
  for (int p = 0; p < static_cast<int>(strip.crossed.size()); ++p) {
    const std::optional<Detour> detour = detour_at(flat, strip, crossings, p);
    if (detour) {
      for (const int h : detour->crossed) cross_or_return(flat, shorter.crossed, h);
      p = detour->bend.last;
      is_other = true;
    } else {
      cross_or_return(flat, shorter.crossed, strip.crossed[static_cast<size_t>(p)]);
    }
  }
  if (!is_other) return std::nullopt;
  trim(flat, shorter);
  return shorter;
}

StraightPath points_of(const TriangleStrip& strip, const Crossings& crossings) {
  StraightPath path{.length = crossings.length, .points = {strip.from}};
  int touched = kNone;  // the vertex at which the path is
  for (size_t p = 0; p < strip.crossed.size(); ++p) {
    const int h = strip.crossed[p];
    const double share = crossings.share[p];
    const Portal& portal = crossings.layout.portals[p];
    const int vertex = share == 0 || share == 1 ? portal.vertex(share == 1) : kNone;
    if (vertex != kNone && vertex == touched) continue;
    touched = vertex;
    SurfacePoint point{.triangle = h / 3};
    point.barycentric[h % 3] = 1 - share;
    point.barycentric[(h + 1) % 3] = share;
    path.points.push_back(point);
  }
  path.points.push_back(strip.to);
  return path;
}

}  // namespace

StraightPath straighten(const FlatTriangles& flat, TriangleStrip strip) {
  Crossings crossings = cross_strip(flat, strip);
  int idle = 0;
  while (idle < kMostIdle) {
    std::optional<TriangleStrip> next = shorter_strip(flat, strip, crossings);
    if (!next) break;
    Crossings next_crossings = cross_strip(flat, *next);
    const bool is_shorter = next_crossings.length < (1 - kShorter) * crossings.length;
    idle = is_shorter ? 0 : idle + 1;
    strip = std::move(*next);
    crossings = std::move(next_crossings);
  }
  return points_of(strip, crossings);
}

}  // namespace palpate::geometry
