// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/surface_query.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/numbers.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "query/surface_tree.h"

namespace palpate::geometry {
namespace {

/// Segments are cut to this cube (local frame) before they become float rays.
constexpr double kSegmentCube = 2;

/// The part of a line from `start` that is inside the cube, as multiples of `along`; none if begin
/// > end.
struct Clip {
  double begin = 0;
  double end = 1;
};

/// \param far the line ends at start + far * along; may be infinite.
Clip clip_to_cube(const Eigen::Vector3d& start, const Eigen::Vector3d& along, double far) {
  Clip clip{.begin = 0, .end = far};
  for (int k = 0; k < 3; ++k) {
    // If both ends are inside, nothing is clipped and they stay exact.
    const bool starts_inside = std::abs(start[k]) <= kSegmentCube;
    if (starts_inside && std::abs(start[k] + far * along[k]) <= kSegmentCube) continue;
    if (along[k] == 0) {
      if (starts_inside) continue;
      return {.begin = 1, .end = 0};
    }
    const double middle = -start[k] / along[k], half = kSegmentCube / std::abs(along[k]);
    clip.begin = std::max(clip.begin, middle - half);
    clip.end = std::min(clip.end, middle + half);
  }
  return clip;
}

/// A segment or ray in the local frame, cut to the cube.
struct LocalLine {
  Eigen::Vector3d start, end;
  /// No Clip, which would be copied as one piece just after it was stored in two; processors wait
  /// long for that.
  double clip_begin, clip_end;

  /// Fraction of the segment, or multiple of the ray's unit, from the fraction of the clipped part.
  [[nodiscard]] double along(double fraction) const {
    return clip_begin + fraction * (clip_end - clip_begin);
  }
};

/// None if the segment is not finite or outside the cube.
std::optional<LocalLine> local_line(const SurfaceTree& tree, const Eigen::Vector3d& start,
                                    const Eigen::Vector3d& end) {
  const Eigen::Vector3d local_start = tree.to_local(start), local_end = tree.to_local(end);
  if (!local_start.allFinite() || !local_end.allFinite()) return std::nullopt;
  const Eigen::Vector3d along = local_end - local_start;
  const Clip clip = clip_to_cube(local_start, along, 1);
  if (clip.begin > clip.end) return std::nullopt;
  return LocalLine{.start = clip.begin > 0 ? local_start + clip.begin * along : local_start,
                   .end = clip.end < 1 ? local_start + clip.end * along : local_end,
                   .clip_begin = clip.begin,
                   .clip_end = clip.end};
}

/// The direction of a ray, scaled to 1 along its main axis, so that its squared length is finite
/// for any length.
Eigen::Vector3d along_ray(const Ray& ray) {
  return ray.direction / ray.direction.cwiseAbs().maxCoeff();
}

/// [mm] length of a ray's `along_ray`.
double ray_unit(const Eigen::Vector3d& along, double scale) { return along.norm() / scale; }

/// None if it is no ray or outside the cube.
std::optional<LocalLine> local_line(const SurfaceTree& tree, const Ray& ray) {
  const Eigen::Vector3d origin = tree.to_local(ray.origin);
  const double largest = ray.direction.cwiseAbs().maxCoeff();
  if (!origin.allFinite() || !ray.direction.allFinite() || !(largest > 0) ||
      !(ray.max_distance >= 0)) {
    return std::nullopt;
  }
  const Eigen::Vector3d along = along_ray(ray);
  // An endless ray does not wait for its unit.
  const double far =
      ray.max_distance < kInfinity ? ray.max_distance / ray_unit(along, tree.scale()) : kInfinity;
  const Clip clip = clip_to_cube(origin, along, far);
  if (clip.begin > clip.end) return std::nullopt;
  return LocalLine{.start = clip.begin > 0 ? origin + clip.begin * along : origin,
                   .end = clip.end > 0 ? origin + clip.end * along : origin,
                   .clip_begin = clip.begin,
                   .clip_end = clip.end};
}

SegmentHit segment_hit(const SurfaceTree& tree, const LocalLine& line,
                       const CrossedTriangle& crossed) {
  return {.at = {.triangle = crossed.triangle, .barycentric = crossed.at.barycentric},
          .position = tree.position(crossed.place, crossed.at.barycentric),
          .fraction = line.along(crossed.at.fraction)};
}

/// \param unit [mm] length of the ray's `along_ray`.
RayHit ray_hit(const SurfaceTree& tree, double unit, const LocalLine& line,
               const CrossedTriangle& crossed) {
  return {.at = {.triangle = crossed.triangle, .barycentric = crossed.at.barycentric},
          .position = tree.position(crossed.place, crossed.at.barycentric),
          .distance = line.along(crossed.at.fraction) * unit};
}

void set_hit(FirstHits& hits, Eigen::Index i, const auto& hit, double along) {
  hits.triangles[i] = hit.at.triangle;
  hits.barycentric.col(i) = hit.at.barycentric;
  hits.positions.col(i) = hit.position;
  hits.along[i] = along;
}

void check_ends(const std::string& function, const Eigen::Ref<const Eigen::Matrix3Xd>& starts,
                const Eigen::Ref<const Eigen::Matrix3Xd>& ends) {
  if (starts.cols() == ends.cols()) return;
  throw InvalidInput(function + ": there are " + std::to_string(starts.cols()) +
                     " starts of segments, but " + std::to_string(ends.cols()) +
                     " ends; pass one end for each start");
}

/// \param ask sets the answer with this index if there is one.
FirstHits collect_hits(Eigen::Index count, const auto& ask) {
  FirstHits hits{.triangles = Eigen::VectorXi::Constant(count, -1),
                 .barycentric = Eigen::Matrix3Xd::Zero(3, count),
                 .positions = Eigen::Matrix3Xd::Constant(3, count, kNan),
                 .along = Eigen::VectorXd::Constant(count, kNan)};
  parallel_for(count, [&](Eigen::Index i) { ask(i, hits); });
  return hits;
}

}  // namespace

SurfaceQuery::SurfaceQuery(const TriangleMesh& mesh) {
  check_mesh(mesh, "SurfaceQuery");
  tree_ = std::make_unique<SurfaceTree>(mesh);
}
SurfaceQuery::~SurfaceQuery() = default;
SurfaceQuery::SurfaceQuery(SurfaceQuery&&) noexcept = default;
SurfaceQuery& SurfaceQuery::operator=(SurfaceQuery&&) noexcept = default;

ClosestPoint SurfaceQuery::closest_point(const Eigen::Vector3d& point) const noexcept {
  ClosestPoint closest;
  closest.position.setConstant(kNan);
  closest.distance = kNan;
  const SurfaceTree& tree = *tree_;
  const Eigen::Vector3d local = tree.to_local(point);
  if (!local.allFinite()) return closest;
  const NearestTriangle nearest = tree.nearest(local, kInfinity);
  if (nearest.triangle < 0) return closest;
  closest.at = {.triangle = nearest.triangle, .barycentric = nearest.at.barycentric};
  closest.position = tree.position(nearest.place, nearest.at.barycentric);
  closest.distance = std::sqrt(nearest.at.squared_distance) / tree.scale();
  return closest;
}

std::optional<SegmentHit> SurfaceQuery::first_hit(const Eigen::Vector3d& start,
                                                  const Eigen::Vector3d& end) const noexcept {
  const std::optional<LocalLine> line = local_line(*tree_, start, end);
  if (!line) return std::nullopt;
  const CrossedTriangle crossed = tree_->first_crossing(line->start, line->end);
  if (crossed.triangle < 0) return std::nullopt;
  return segment_hit(*tree_, *line, crossed);
}

std::optional<RayHit> SurfaceQuery::first_hit(const Ray& ray) const noexcept {
  const std::optional<LocalLine> line = local_line(*tree_, ray);
  if (!line) return std::nullopt;
  const CrossedTriangle crossed = tree_->first_crossing(line->start, line->end);
  if (crossed.triangle < 0) return std::nullopt;
  return ray_hit(*tree_, ray_unit(along_ray(ray), tree_->scale()), *line, crossed);
}

std::vector<SegmentHit> SurfaceQuery::all_hits(const Eigen::Vector3d& start,
                                               const Eigen::Vector3d& end) const {
  std::vector<SegmentHit> hits;
  const std::optional<LocalLine> line = local_line(*tree_, start, end);
  if (!line) return hits;
  const std::vector<CrossedTriangle> crossings = tree_->all_crossings(line->start, line->end);
  hits.reserve(crossings.size());
  for (const CrossedTriangle& crossed : crossings) {
    hits.push_back(segment_hit(*tree_, *line, crossed));
  }
  return hits;
}

std::vector<RayHit> SurfaceQuery::all_hits(const Ray& ray) const {
  std::vector<RayHit> hits;
  const std::optional<LocalLine> line = local_line(*tree_, ray);
  if (!line) return hits;
  const std::vector<CrossedTriangle> crossings = tree_->all_crossings(line->start, line->end);
  hits.reserve(crossings.size());
  const double unit = ray_unit(along_ray(ray), tree_->scale());
  for (const CrossedTriangle& crossed : crossings) {
    hits.push_back(ray_hit(*tree_, unit, *line, crossed));
  }
  return hits;
}

void SurfaceQuery::move_vertices(const Eigen::Ref<const Eigen::Matrix3Xd>& vertices) {
  const Eigen::Index expected = tree_->mesh().vertices.cols();
  if (vertices.cols() != expected) {
    throw InvalidInput("SurfaceQuery::move_vertices: there are " + std::to_string(vertices.cols()) +
                       " vertices, but the mesh has " + std::to_string(expected) +
                       "; pass all of them");
  }
  for (Eigen::Index v = 0; v < expected; ++v) {
    if (vertices.col(v).allFinite()) continue;
    throw InvalidInput("SurfaceQuery::move_vertices: vertex " + std::to_string(v) +
                       " is not finite");
  }
  tree_->move_vertices(vertices);
}

ClosestPoints closest_points(const SurfaceQuery& query,
                             const Eigen::Ref<const Eigen::Matrix3Xd>& points) {
  const Eigen::Index count = points.cols();
  ClosestPoints closest{.triangles = Eigen::VectorXi(count),
                        .barycentric = Eigen::Matrix3Xd(3, count),
                        .positions = Eigen::Matrix3Xd(3, count),
                        .distances = Eigen::VectorXd(count)};
  parallel_for(count, [&](Eigen::Index i) {
    const ClosestPoint one = query.closest_point(points.col(i));
    closest.triangles[i] = one.at.triangle;
    closest.barycentric.col(i) = one.at.barycentric;
    closest.positions.col(i) = one.position;
    closest.distances[i] = one.distance;
  });
  return closest;
}

FirstHits first_hits(const SurfaceQuery& query, const Eigen::Ref<const Eigen::Matrix3Xd>& starts,
                     const Eigen::Ref<const Eigen::Matrix3Xd>& ends) {
  check_ends("first_hits", starts, ends);
  return collect_hits(starts.cols(), [&](Eigen::Index i, FirstHits& hits) {
    if (const auto hit = query.first_hit(starts.col(i), ends.col(i))) {
      set_hit(hits, i, *hit, hit->fraction);
    }
  });
}

FirstHits first_hits(const SurfaceQuery& query, std::span<const Ray> rays) {
  return collect_hits(static_cast<Eigen::Index>(rays.size()), [&](Eigen::Index i, FirstHits& hits) {
    if (const auto hit = query.first_hit(rays[static_cast<std::size_t>(i)])) {
      set_hit(hits, i, *hit, hit->distance);
    }
  });
}

AllHits all_hits(const SurfaceQuery& query, const Eigen::Ref<const Eigen::Matrix3Xd>& starts,
                 const Eigen::Ref<const Eigen::Matrix3Xd>& ends) {
  check_ends("all_hits", starts, ends);
  std::vector<std::vector<SegmentHit>> of_segment(static_cast<std::size_t>(starts.cols()));
  parallel_for(starts.cols(), [&](Eigen::Index i) {
    of_segment[static_cast<std::size_t>(i)] = query.all_hits(starts.col(i), ends.col(i));
  });
  Eigen::Index count = 0;
  for (const std::vector<SegmentHit>& hits : of_segment) {
    count += static_cast<Eigen::Index>(hits.size());
  }
  AllHits all{.segments = Eigen::VectorXi(count),
              .triangles = Eigen::VectorXi(count),
              .barycentric = Eigen::Matrix3Xd(3, count),
              .positions = Eigen::Matrix3Xd(3, count),
              .along = Eigen::VectorXd(count)};
  Eigen::Index i = 0;
  for (std::size_t segment = 0; segment < of_segment.size(); ++segment) {
    for (const SegmentHit& hit : of_segment[segment]) {
      all.segments[i] = static_cast<int>(segment);
      all.triangles[i] = hit.at.triangle;
      all.barycentric.col(i) = hit.at.barycentric;
      all.positions.col(i) = hit.position;
      all.along[i] = hit.fraction;
      ++i;
    }
  }
  return all;
}

}  // namespace palpate::geometry
