// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "playback/surface_side.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "palpate/geometry/mesh_measures.h"

namespace palpate::haptics {
namespace {

// Distance outside the surface at which the search for a hit starts, as a fraction of the surface's
// diagonal: far above rounding (1e-16), far below what a user can feel.
constexpr double kOffsetRatio = 1e-9;
// A contact lies on an edge if it is at most this number of offsets away. Even in a crease of 0.6
// degrees the start is in front of both sides.
constexpr double kOnEdge = 100;
// The start is in front of all sides of a crease if its direction has at least this cosine to their
// normals.
constexpr double kLeastOpening = 1e-6;

}  // namespace

SurfaceSide::SurfaceSide(const geometry::TriangleMesh& surface, const geometry::SurfaceQuery& query)
    : walk_(surface), query_(query), offset_(kOffsetRatio * geometry::bounding_diagonal(surface)) {}

Eigen::Vector3d SurfaceSide::centroid(int triangle) const noexcept {
  return (walk_.corner(triangle, 0) + walk_.corner(triangle, 1) + walk_.corner(triangle, 2)) / 3;
}

bool SurfaceSide::enters(const Eigen::Vector3d& from, const Eigen::Vector3d& tool,
                         TouchPoint& contact) const noexcept {
  const std::optional<geometry::SegmentHit> hit = query_.first_hit(from, tool);
  if (!hit) return false;
  const Eigen::Vector3d& normal = walk_.normal(hit->at.triangle);
  // From inside, or a triangle without area (NaN): no contact.
  if (!((tool - from).dot(normal) < 0)) return false;
  contact = {hit->position, normal, hit->at};
  return true;
}

Eigen::Vector3d SurfaceSide::lifted(const TouchPoint& contact) const noexcept {
  const TouchedTriangles touched =
      walk_.touched({contact.at.triangle, contact.position}, kOnEdge * offset_);
  Eigen::Vector3d up = contact.normal;
  for (int i = 1; i < touched.count; ++i) {
    const int t = touched.triangles[static_cast<std::size_t>(i)];
    const bool rises = (centroid(t) - contact.position).dot(contact.normal) > 0;
    if (rises && walk_.normal(t).allFinite()) up += walk_.normal(t);
  }
  const double opening = std::max(up.dot(contact.normal), kLeastOpening);
  return contact.position + offset_ / opening * up;
}

bool SurfaceSide::stays(const TouchPoint& contact, const Eigen::Vector3d& tool) const noexcept {
  const Eigen::Vector3d displacement = tool - contact.position;
  if (displacement.dot(contact.normal) < 0) return true;
  // In a crease the tool is inside as long as it is behind one of the sides.
  const TouchedTriangles touched =
      walk_.touched({contact.at.triangle, contact.position}, kOnEdge * offset_);
  for (int i = 1; i < touched.count; ++i) {
    const int t = touched.triangles[static_cast<std::size_t>(i)];
    const bool rises = (centroid(t) - contact.position).dot(contact.normal) > offset_;
    if (rises && displacement.dot(walk_.normal(t)) < 0) return true;
  }
  TouchPoint elsewhere;
  return enters(lifted(contact), tool, elsewhere);
}

// At an edge or a vertex the sum of the normals, weighted with the angles of
// their triangles there, tells the side (Baerentzen and Aanaes 2005): in a sharp crease a tool may
// be behind one of the triangles and in front of another.
double SurfaceSide::signed_distance(const Eigen::Vector3d& tool,
                                    TouchPoint& nearest) const noexcept {
  const geometry::ClosestPoint closest = query_.closest_point(tool);
  if (closest.at.triangle < 0) return 0;
  const SurfacePlace place{closest.at.triangle, closest.position};
  const TouchedTriangles touched = walk_.touched(place, kOnEdge * offset_);
  if (touched.on_border) return 0;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();
  for (int i = 0; i < touched.count; ++i) {
    const int t = touched.triangles[static_cast<std::size_t>(i)];
    if (walk_.normal(t).allFinite())
      normal += walk_.angle(t, closest.position, kOnEdge * offset_) * walk_.normal(t);
  }
  nearest = {closest.position, walk_.normal(closest.at.triangle), closest.at};
  return std::copysign(closest.distance, (tool - closest.position).dot(normal));
}

TouchPoint SurfaceSide::touch_point(const SurfacePlace& place,
                                    const Eigen::Vector3d& fallback) const noexcept {
  const Eigen::Vector3d& normal = walk_.normal(place.triangle);
  return {place.position, normal.allFinite() ? normal : fallback, walk_.point(place)};
}

}  // namespace palpate::haptics
