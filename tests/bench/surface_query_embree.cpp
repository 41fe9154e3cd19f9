// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <embree3/rtcore.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "surface_query_peers.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3f;

/// Nearest point by the seven regions of Ericson 2005, section 5.1.5.
Vector3f nearest_point(const Vector3f& p, const Vector3f& a, const Vector3f& b, const Vector3f& c) {
  const Vector3f ab = b - a, ac = c - a;
  const float d1 = ab.dot(p - a), d2 = ac.dot(p - a);
  if (d1 <= 0 && d2 <= 0) return a;
  const float d3 = ab.dot(p - b), d4 = ac.dot(p - b);
  if (d3 >= 0 && d4 <= d3) return b;
  const float d5 = ab.dot(p - c), d6 = ac.dot(p - c);
  if (d6 >= 0 && d5 <= d6) return c;
  const float vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return a + d1 / (d1 - d3) * ab;
  const float vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return a + d2 / (d2 - d6) * ac;
  const float va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    return b + (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b);
  }
  const float scale = 1 / (va + vb + vc);
  return a + vb * scale * ab + vc * scale * ac;
}

struct Search {
  const float* vertices;
  const unsigned* triangles;
  Vector3f point;
  float distance = std::numeric_limits<float>::infinity();
  unsigned triangle = RTC_INVALID_GEOMETRY_ID;
};

bool visit(RTCPointQueryFunctionArguments* args) {
  Search& search = *static_cast<Search*>(args->userPtr);
  const unsigned* t = search.triangles + std::size_t{3} * args->primID;
  const auto corner = [&](int k) {
    return Vector3f(Vector3f::Map(search.vertices + std::size_t{3} * t[k]));
  };
  const float distance =
      (nearest_point(search.point, corner(0), corner(1), corner(2)) - search.point).norm();
  if (!(distance < search.distance)) return false;
  search.distance = distance;
  search.triangle = args->primID;
  args->query->radius = distance;
  return true;
}

RTCRayHit ray_hit(const Eigen::Vector3d& origin, const Eigen::Vector3d& along, float far) {
  const Vector3f o = origin.cast<float>(), d = along.cast<float>();
  RTCRayHit hit{};
  hit.ray = {.org_x = o[0],
             .org_y = o[1],
             .org_z = o[2],
             .tnear = 0,
             .dir_x = d[0],
             .dir_y = d[1],
             .dir_z = d[2],
             .time = 0,
             .tfar = far,
             .mask = ~0U,
             .id = 0,
             .flags = 0};
  hit.hit.geomID = RTC_INVALID_GEOMETRY_ID;
  hit.hit.instID[0] = RTC_INVALID_GEOMETRY_ID;
  return hit;
}

/// A query that collects crossings.
struct Collection {
  RTCIntersectContext context;  // first, as Embree passes on its address
  std::vector<double> crossings;
};

/// Refuses each crossing, so that the ray goes on.
void collect(const RTCFilterFunctionNArguments* args) {
  args->valid[0] = 0;
  reinterpret_cast<Collection*>(args->context)
      ->crossings.push_back(static_cast<double>(RTCRayN_tfar(args->ray, args->N, 0)));
}

}  // namespace

struct EmbreePeer::Impl {
  RTCDevice device = rtcNewDevice(nullptr);
  RTCScene scene = rtcNewScene(device);
  RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  float* vertices = nullptr;
  unsigned* triangles = nullptr;
};

EmbreePeer::EmbreePeer(const geometry::TriangleMesh& mesh, Purpose purpose)
    : impl_(std::make_unique<Impl>()) {
  if (purpose == Purpose::moves) rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_DYNAMIC);
  if (purpose == Purpose::all_hits) {
    rtcSetSceneFlags(impl_->scene, RTC_SCENE_FLAG_CONTEXT_FILTER_FUNCTION);
  }
  impl_->vertices = static_cast<float*>(
      rtcSetNewGeometryBuffer(impl_->geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                              3 * sizeof(float), static_cast<std::size_t>(mesh.vertices.cols())));
  impl_->triangles = static_cast<unsigned*>(rtcSetNewGeometryBuffer(
      impl_->geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(unsigned),
      static_cast<std::size_t>(mesh.triangles.cols())));
  Eigen::Matrix3Xf::Map(impl_->vertices, 3, mesh.vertices.cols()) = mesh.vertices.cast<float>();
  Eigen::Matrix<unsigned, 3, Eigen::Dynamic>::Map(impl_->triangles, 3, mesh.triangles.cols()) =
      mesh.triangles.cast<unsigned>();
  rtcCommitGeometry(impl_->geometry);
  rtcAttachGeometry(impl_->scene, impl_->geometry);
  rtcCommitScene(impl_->scene);
  if (rtcGetDeviceError(impl_->device) != RTC_ERROR_NONE) throw std::runtime_error("Embree");
}

EmbreePeer::~EmbreePeer() {
  rtcReleaseGeometry(impl_->geometry);
  rtcReleaseScene(impl_->scene);
  rtcReleaseDevice(impl_->device);
}

double EmbreePeer::distance(const Eigen::Vector3d& point) const {
  Search search{
      .vertices = impl_->vertices, .triangles = impl_->triangles, .point = point.cast<float>()};
  RTCPointQuery query{};
  query.x = search.point[0];
  query.y = search.point[1];
  query.z = search.point[2];
  query.radius = std::numeric_limits<float>::infinity();
  RTCPointQueryContext context;
  rtcInitPointQueryContext(&context);
  rtcPointQuery(impl_->scene, &query, &context, visit, &search);
  return static_cast<double>(search.distance);
}

double EmbreePeer::first_crossing(const Eigen::Vector3d& origin, const Eigen::Vector3d& along,
                                  float far) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRayHit hit = ray_hit(origin, along, far);
  rtcIntersect1(impl_->scene, &context, &hit);
  if (hit.hit.geomID == RTC_INVALID_GEOMETRY_ID) return std::numeric_limits<double>::quiet_NaN();
  return static_cast<double>(hit.ray.tfar);
}

std::vector<double> EmbreePeer::all_crossings(const Eigen::Vector3d& origin,
                                              const Eigen::Vector3d& along) const {
  Collection collection;
  rtcInitIntersectContext(&collection.context);
  collection.context.filter = collect;
  RTCRayHit hit = ray_hit(origin, along, std::numeric_limits<float>::infinity());
  rtcIntersect1(impl_->scene, &collection.context, &hit);
  std::sort(collection.crossings.begin(), collection.crossings.end());
  return std::move(collection.crossings);
}

void EmbreePeer::move(const Eigen::Matrix3Xd& vertices) {
  Eigen::Matrix3Xf::Map(impl_->vertices, 3, vertices.cols()) = vertices.cast<float>();
  rtcSetGeometryBuildQuality(impl_->geometry, RTC_BUILD_QUALITY_REFIT);
  rtcUpdateGeometryBuffer(impl_->geometry, RTC_BUFFER_TYPE_VERTEX, 0);
  rtcCommitGeometry(impl_->geometry);
  rtcCommitScene(impl_->scene);
}

}  // namespace palpate::bench
