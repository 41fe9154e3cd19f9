// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/triangle_strip.h"

#include <algorithm>
#include <optional>
#include <string>

#include "base/numbers.h"
#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

/// The corner of a triangle that is not on its half-edge.
int apex_corner(int half_edge) { return (half_edge + 2) % 3; }

/// The half-edges to cross from one triangle to another round a vertex.
/// \param h  the half-edge of the first triangle that starts at the vertex
/// \return none if the border is in between
std::optional<std::vector<int>> turn_round(const FlatTriangles& flat, int h, int triangle,
                                           bool to_left) {
  std::vector<int> crossed;
  const int first = h;
  while (h / 3 != triangle) {
    const int through = to_left ? last_half_edge(h) : h;
    const int across = flat[through].opposite;
    if (across == kNone) return std::nullopt;
    crossed.push_back(through);
    h = to_left ? across : next_half_edge(across);
    if (h == first) return std::nullopt;  // the triangle is in another fan
  }
  return crossed;
}

/// The half-edges to cross from one triangle that has a place to another one that has it.
std::optional<std::vector<int>> way_between(const FlatTriangles& flat, const SurfacePoint& from,
                                            int triangle) {
  if (from.triangle == triangle) return std::vector<int>{};
  const auto corners = (from.barycentric.array() > 0).count();
  if (corners == 2) {
    Eigen::Index off = 0;
    from.barycentric.minCoeff(&off);
    return std::vector<int>{3 * from.triangle + (static_cast<int>(off) + 1) % 3};
  }
  Eigen::Index corner = 0;
  from.barycentric.maxCoeff(&corner);
  const int h = 3 * from.triangle + static_cast<int>(corner);
  const auto left = turn_round(flat, h, triangle, true);
  const auto right = turn_round(flat, h, triangle, false);
  if (left && right) return left->size() <= right->size() ? left : right;
  return left ? left : right;
}

/// A triangle that has two places, as they are named in it; preferably the given one.
struct CommonTriangle {
  SurfacePoint first, second;
};
std::optional<CommonTriangle> common_triangle(const std::vector<SurfacePoint>& first,
                                              const std::vector<SurfacePoint>& second,
                                              int preferred) {
  std::optional<CommonTriangle> found;
  for (const SurfacePoint& a : first) {
    const auto b = std::find_if(second.begin(), second.end(), [&](const SurfacePoint& other) {
      return other.triangle == a.triangle;
    });
    if (b == second.end()) continue;
    if (!found || a.triangle == preferred) found = {a, *b};
  }
  return found;
}

}  // namespace

Eigen::Vector3d clean_weights(const SurfacePoint& point) {
  const Eigen::Vector3d positive = point.barycentric.cwiseMax(0);
  return positive / positive.sum();
}

SurfacePoint named_across(const FlatTriangles& flat, int half_edge, const SurfacePoint& point) {
  const int across = flat[half_edge].opposite;
  SurfacePoint named{.triangle = across / 3};
  named.barycentric[across % 3] = point.barycentric[(half_edge + 1) % 3];
  named.barycentric[(across + 1) % 3] = point.barycentric[half_edge % 3];
  return named;
}

std::vector<SurfacePoint> names_of(const FlatTriangles& flat, const SurfacePoint& point) {
  const SurfacePoint clean{.triangle = point.triangle, .barycentric = clean_weights(point)};
  const auto corners = (clean.barycentric.array() > 0).count();
  std::vector<SurfacePoint> names;
  if (corners == 1) {
    Eigen::Index corner = 0;
    clean.barycentric.maxCoeff(&corner);
    const int vertex = flat[3 * clean.triangle + static_cast<int>(corner)].start;
    for (const int h : flat.from(vertex)) names.push_back(corner_point(h / 3, h % 3));
    return names;
  }
  names.push_back(clean);
  if (corners == 2) {
    Eigen::Index off = 0;
    clean.barycentric.minCoeff(&off);
    const int h = 3 * clean.triangle + (static_cast<int>(off) + 1) % 3;
    if (flat[h].opposite != kNone) names.push_back(named_across(flat, h, clean));
  }
  return names;
}

void cross_or_return(const FlatTriangles& flat, std::vector<int>& crossed, int half_edge) {
  if (!crossed.empty() && flat[crossed.back()].opposite == half_edge) {
    crossed.pop_back();
  } else {
    crossed.push_back(half_edge);
  }
}

void trim(const FlatTriangles& flat, TriangleStrip& strip) {
  std::vector<int>& crossed = strip.crossed;
  auto first = crossed.begin();
  for (; first != crossed.end(); ++first) {
    if (strip.from.barycentric[apex_corner(*first)] > 0) break;
    strip.from = named_across(flat, *first, strip.from);
  }
  crossed.erase(crossed.begin(), first);
  while (!crossed.empty()) {
    const int across = flat[crossed.back()].opposite;
    if (strip.to.barycentric[apex_corner(across)] > 0) break;
    strip.to = named_across(flat, across, strip.to);
    crossed.pop_back();
  }
}

std::vector<TriangleStrip> strips_along(const FlatTriangles& flat,
                                        std::span<const SurfacePoint> points) {
  std::vector<TriangleStrip> strips;
  std::vector<SurfacePoint> names = names_of(flat, points.front());
  SurfacePoint now;  // the end of the strip so far, as it is named in its last triangle
  for (size_t i = 1; i < points.size(); ++i) {
    std::vector<SurfacePoint> next_names = names_of(flat, points[i]);
    const auto common = common_triangle(names, next_names, now.triangle);
    if (!common) {
      throw InvalidInput("straighten_path: point " + std::to_string(i) +
                         " is in no triangle that has the point before it, so the way between "
                         "them is not known; pass points that follow each other in a triangle or "
                         "along an edge, as shortest_paths gives them");
    }
    const auto way = strips.empty() ? std::nullopt : way_between(flat, now, common->first.triangle);
    if (way) {
      for (const int h : *way) cross_or_return(flat, strips.back().crossed, h);
    } else {
      strips.push_back({.from = common->first, .crossed = {}, .to = {}});
    }
    strips.back().to = now = common->second;
    names = std::move(next_names);
  }
  for (TriangleStrip& strip : strips) trim(flat, strip);
  return strips;
}

}  // namespace palpate::geometry
