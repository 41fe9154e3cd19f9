// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/surface_query.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <type_traits>

#include "palpate/error.h"
#include "triangle_primitives.h"

// Embree sees boxes only, one a triangle, a little larger than the triangle. It culls in single
// precision; which triangle is nearest or first is decided in double in the callbacks. All of this
// happens in the local frame: the mesh centred on its bounding box and scaled by a power of two to
// [-1, 1], which costs no precision.

namespace palpate::geometry {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Boxes and search radii are enlarged by this fraction of the largest coordinate involved. A point
/// that is rounded to float is off by half a float epsilon of it, and the box test adds a few
/// roundings.
constexpr double kFloatMargin = 16 * static_cast<double>(std::numeric_limits<float>::epsilon());

/// Beyond this distance from the mesh (local frame) the margin comes near the mesh's own size:
/// single precision cannot cull any more and every triangle is visited.
constexpr double kCullingReach = 0x1p16;

/// Segments are cut to this cube (local frame) before they become float rays.
constexpr double kSegmentCube = 2;

/// An end of a segment is on the surface iff its distance to it is at most this fraction of the
/// largest coordinate of the mesh: the rounding of a position computed from barycentric
/// coordinates.
constexpr double kOnSurface = 8 * std::numeric_limits<double>::epsilon();

float round_up(double x) {
  return std::nextafter(static_cast<float>(x), std::numeric_limits<float>::infinity());
}
float round_down(double x) {
  return std::nextafter(static_cast<float>(x), -std::numeric_limits<float>::infinity());
}

/// A mesh with its vertices in the local frame too.
struct LocalMesh {
  TriangleMesh mesh;
  Eigen::Vector3d centre;
  double scale;  ///< local = (world - centre) * scale; a power of two
  Eigen::Matrix3Xd local;

  explicit LocalMesh(const TriangleMesh& surface) : mesh(surface) {
    const Eigen::Vector3d lower = mesh.vertices.rowwise().minCoeff();
    const Eigen::Vector3d upper = mesh.vertices.rowwise().maxCoeff();
    centre = lower / 2 + upper / 2;
    const double half_extent = (upper / 2 - lower / 2).maxCoeff();
    // Not beyond the range in which the scale and its inverse are normal numbers.
    constexpr int kMaxExponent = 1000;
    const int exponent = half_extent > 0 ? std::ilogb(half_extent) + 1 : 0;
    scale = std::ldexp(1.0, -std::clamp(exponent, -kMaxExponent, kMaxExponent));
    local = (mesh.vertices.colwise() - centre) * scale;
  }
  [[nodiscard]] Eigen::Vector3d to_local(const Eigen::Vector3d& world) const {
    return (world - centre) * scale;
  }
  [[nodiscard]] Corners corners(unsigned triangle) const {
    const Eigen::Vector3i of = mesh.triangles.col(triangle);
    return {local.col(of[0]), local.col(of[1]), local.col(of[2])};
  }
};

/// Equals are decided by the lower index, so the order in which Embree visits does not matter.
bool improves(double candidate, unsigned triangle, double best, int best_triangle) {
  return candidate < best ||
         (candidate == best && best_triangle >= 0 && static_cast<int>(triangle) < best_triangle);
}

/// What a closest-point query remembers while Embree walks the tree.
struct NearestSearch {
  const LocalMesh* surface;
  Eigen::Vector3d point;
  Nearest best;
  int triangle = -1;
};

/// What a segment query remembers while Embree walks the tree.
struct CrossingSearch {
  RTCIntersectContext context;  ///< first: Embree hands back a pointer to it
  const LocalMesh* surface;
  ShearedSegment segment;
  Crossing best;
  int triangle = -1;
};

/// A search radius in float that no triangle at `distance` or nearer escapes.
float search_radius(double distance, const Eigen::Vector3d& point) {
  const double reach = point.cwiseAbs().maxCoeff();
  if (!(distance < kInfinity) || reach > kCullingReach) {
    return std::numeric_limits<float>::infinity();
  }
  return round_up(distance * (1 + kFloatMargin) + kFloatMargin * (1 + reach));
}

bool visit_nearest(RTCPointQueryFunctionArguments* args) {
  NearestSearch& search = *static_cast<NearestSearch*>(args->userPtr);
  const Nearest candidate =
      nearest_on_triangle(search.point, search.surface->corners(args->primID));
  if (!improves(candidate.squared_distance, args->primID, search.best.squared_distance,
                search.triangle)) {
    return false;
  }
  search.best = candidate;
  search.triangle = static_cast<int>(args->primID);
  const float radius = search_radius(std::sqrt(candidate.squared_distance), search.point);
  if (!(radius < args->query->radius)) return false;
  args->query->radius = radius;
  return true;
}

void visit_crossing(const RTCIntersectFunctionNArguments* args) {
  if (args->valid[0] == 0) return;
  CrossingSearch& search = *reinterpret_cast<CrossingSearch*>(args->context);
  const Crossing candidate = cross_triangle(search.segment, search.surface->corners(args->primID));
  if (!improves(candidate.fraction, args->primID, search.best.fraction, search.triangle)) return;
  search.best = candidate;
  search.triangle = static_cast<int>(args->primID);
  RTCRay& ray = reinterpret_cast<RTCRayHit*>(args->rayhit)->ray;
  ray.tfar = std::min(ray.tfar, round_up(candidate.fraction * (1 + kFloatMargin)));
}

void triangle_bounds(const RTCBoundsFunctionArguments* args) {
  const Corners corners =
      static_cast<const LocalMesh*>(args->geometryUserPtr)->corners(args->primID);
  const Eigen::Vector3d lower = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
  const Eigen::Vector3d upper = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
  RTCBounds& box = *args->bounds_o;
  box.lower_x = round_down(lower[0] - kFloatMargin);
  box.lower_y = round_down(lower[1] - kFloatMargin);
  box.lower_z = round_down(lower[2] - kFloatMargin);
  box.upper_x = round_up(upper[0] + kFloatMargin);
  box.upper_y = round_up(upper[1] + kFloatMargin);
  box.upper_z = round_up(upper[2] + kFloatMargin);
}

/// The part of a segment inside the cube, as fractions of the segment; none if begin > end.
struct Clip {
  double begin = 0;
  double end = 1;
};

Clip clip_to_cube(const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
  Clip clip;
  for (int k = 0; k < 3; ++k) {
    // Inside both ends nothing is cut, and 0 and 1 stay exact.
    if (std::abs(start[k]) <= kSegmentCube && std::abs(end[k]) <= kSegmentCube) continue;
    const double along = end[k] - start[k];
    if (along == 0) return {.begin = 1, .end = 0};
    const double one = (-kSegmentCube - start[k]) / along;
    const double other = (kSegmentCube - start[k]) / along;
    clip.begin = std::max(clip.begin, std::min(one, other));
    clip.end = std::min(clip.end, std::max(one, other));
  }
  return clip;
}

RTCRayHit make_ray(const Eigen::Vector3d& start, const Eigen::Vector3d& end) {
  RTCRayHit hit{};
  const Eigen::Vector3f origin = start.cast<float>();
  const Eigen::Vector3f direction = (end - start).cast<float>();
  hit.ray.org_x = origin[0];
  hit.ray.org_y = origin[1];
  hit.ray.org_z = origin[2];
  hit.ray.dir_x = direction[0];
  hit.ray.dir_y = direction[1];
  hit.ray.dir_z = direction[2];
  hit.ray.tnear = 0;
  hit.ray.tfar = round_up(1);
  hit.ray.mask = ~0U;
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  hit.hit.primID = RTC_INVALID_GEOMETRY_ID;
  hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return hit;
}

struct ReleaseDevice {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct ReleaseScene {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};

}  // namespace

struct SurfaceQuery::Impl {
  LocalMesh surface;
  double on_surface;  ///< kOnSurface in the local frame
  std::unique_ptr<std::remove_pointer_t<RTCDevice>, ReleaseDevice> device;
  std::unique_ptr<std::remove_pointer_t<RTCScene>, ReleaseScene> scene;  ///< goes before the device

  explicit Impl(const TriangleMesh& mesh);
  void build_scene();
  [[nodiscard]] NearestSearch nearest(const Eigen::Vector3d& local, double radius) const;
  [[nodiscard]] CrossingSearch first_crossing(const Eigen::Vector3d& start,
                                              const Eigen::Vector3d& end) const;
  [[nodiscard]] std::optional<SegmentHit> touch(const Eigen::Vector3d& local,
                                                double fraction) const;
};

SurfaceQuery::Impl::Impl(const TriangleMesh& mesh)
    : surface(mesh),
      on_surface(kOnSurface * mesh.vertices.cwiseAbs().maxCoeff() * surface.scale),
      device(rtcNewDevice(nullptr)),
      scene(rtcNewScene(device.get())) {
  build_scene();
}

void SurfaceQuery::Impl::build_scene() {
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  RTCGeometry boxes = rtcNewGeometry(device.get(), RTC_GEOMETRY_TYPE_USER);
  rtcSetGeometryUserPrimitiveCount(boxes, static_cast<unsigned>(surface.mesh.triangles.cols()));
  rtcSetGeometryUserData(boxes, &surface);
  rtcSetGeometryBoundsFunction(boxes, triangle_bounds, nullptr);
  rtcSetGeometryIntersectFunction(boxes, visit_crossing);
  rtcCommitGeometry(boxes);
  rtcAttachGeometry(scene.get(), boxes);
  rtcReleaseGeometry(boxes);
  rtcCommitScene(scene.get());
  if (rtcGetDeviceError(device.get()) != RTC_ERROR_NONE) {
    throw SolverError("SurfaceQuery: the search tree of " +
                      std::to_string(surface.mesh.triangles.cols()) +
                      " triangles could not be built; is there enough memory?");
  }
}

/// Nearest point no further than `radius`, triangle -1 if there is none. May find one a little
/// further.
NearestSearch SurfaceQuery::Impl::nearest(const Eigen::Vector3d& local, double radius) const {
  NearestSearch search{.surface = &surface, .point = local, .best = {}, .triangle = -1};
  // Far away every triangle is visited whatever the float point is, as long as it is a number.
  const Eigen::Vector3f point =
      local.cwiseMax(-kCullingReach).cwiseMin(kCullingReach).cast<float>();
  RTCPointQuery query{};
  query.x = point[0];
  query.y = point[1];
  query.z = point[2];
  query.radius = search_radius(radius, local);
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(scene.get(), &query, &context, visit_nearest, &search);
  return search;
}

CrossingSearch SurfaceQuery::Impl::first_crossing(const Eigen::Vector3d& start,
                                                  const Eigen::Vector3d& end) const {
  CrossingSearch search{.context = {},
                        .surface = &surface,
                        .segment = ShearedSegment(start, end),
                        .best = {},
                        .triangle = -1};
  rtcInitIntersectContext(&search.context);
  RTCRayHit ray = make_ray(start, end);
  rtcIntersect1(scene.get(), &search.context, &ray);
  return search;
}

/// The hit of a segment whose end is on the surface, within rounding.
std::optional<SegmentHit> SurfaceQuery::Impl::touch(const Eigen::Vector3d& local,
                                                    double fraction) const {
  const NearestSearch search = nearest(local, on_surface);
  if (search.triangle < 0 || std::sqrt(search.best.squared_distance) > on_surface) {
    return std::nullopt;
  }
  const SurfacePoint at{.triangle = search.triangle, .barycentric = search.best.barycentric};
  return SegmentHit{.at = at, .position = position(surface.mesh, at), .fraction = fraction};
}

SurfaceQuery::SurfaceQuery(const TriangleMesh& mesh) {
  check_mesh(mesh, "SurfaceQuery");
  impl_ = std::make_unique<Impl>(mesh);
}
SurfaceQuery::~SurfaceQuery() = default;
SurfaceQuery::SurfaceQuery(SurfaceQuery&&) noexcept = default;
SurfaceQuery& SurfaceQuery::operator=(SurfaceQuery&&) noexcept = default;

ClosestPoint SurfaceQuery::closest_point(const Eigen::Vector3d& point) const noexcept {
  ClosestPoint closest;
  closest.position.setConstant(kNan);
  closest.distance = kNan;
  const Eigen::Vector3d local = impl_->surface.to_local(point);
  if (!local.allFinite()) return closest;
  const NearestSearch search = impl_->nearest(local, kInfinity);
  if (search.triangle < 0) return closest;
  closest.at = {.triangle = search.triangle, .barycentric = search.best.barycentric};
  closest.position = position(impl_->surface.mesh, closest.at);
  closest.distance = std::sqrt(search.best.squared_distance) / impl_->surface.scale;
  return closest;
}

std::optional<SegmentHit> SurfaceQuery::first_hit(const Eigen::Vector3d& start,
                                                  const Eigen::Vector3d& end) const noexcept {
  const Eigen::Vector3d local_start = impl_->surface.to_local(start);
  const Eigen::Vector3d local_end = impl_->surface.to_local(end);
  if (!local_start.allFinite() || !local_end.allFinite()) return std::nullopt;
  if (const auto hit = impl_->touch(local_start, 0)) return hit;
  const Clip clip = clip_to_cube(local_start, local_end);
  const Eigen::Vector3d along = local_end - local_start;
  const Eigen::Vector3d from = clip.begin > 0 ? local_start + clip.begin * along : local_start;
  const Eigen::Vector3d to = clip.end < 1 ? local_start + clip.end * along : local_end;
  if (clip.begin <= clip.end && from != to) {
    const CrossingSearch search = impl_->first_crossing(from, to);
    if (search.triangle >= 0) {
      const SurfacePoint at{.triangle = search.triangle, .barycentric = search.best.barycentric};
      return SegmentHit{.at = at,
                        .position = position(impl_->surface.mesh, at),
                        .fraction = clip.begin + search.best.fraction * (clip.end - clip.begin)};
    }
  }
  return impl_->touch(local_end, 1);
}

}  // namespace palpate::geometry
