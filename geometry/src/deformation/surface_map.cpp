// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/surface_map.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "base/numbers.h"
#include "deformation/elastic_surface.h"
#include "deformation/landmark_warp.h"
#include "deformation/nearest_rotation.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/surface_query.h"

namespace palpate::geometry {
namespace {

// Landmarks are collinear iff their spread across the line is at most this fraction of that along
// it. The rotation about the line would then be poorly determined.
constexpr double kInLine = 0.05;

// First and last elastic length relative to the diagonal, number of levels, and number of times the
// closest points are updated at each.
constexpr double kFirstLength = 0.25, kLastLength = 0.01;
constexpr int kElasticLevels = 8, kElasticRounds = 6;
// Relative to the diagonal; smaller moves are rounding.
constexpr double kRoundingMove = 1e-12;
// Weight of the attraction of border vertices to the border, relative to that of other vertices to
// the surface.
constexpr double kBorderWeight = 10;

void check_topology(const TriangleMesh& source, const TriangleMesh& target) {
  check_mesh(source, "map_surface: the source");
  check_mesh(target, "map_surface: the target");
  const auto compare = [](const char* what, int of_source, int of_target) {
    if (of_source == of_target) return;
    throw InvalidInput(fmt::format(
        "map_surface: source and target differ in the number of {}, {} and {}: surfaces of "
        "different topology have no sensible map. Fill holes or cut the surfaces so that they "
        "agree",
        what, of_source, of_target));
  };
  const int components = connected_components(source).count;
  compare("components", components, connected_components(target).count);
  if (components != 1) {
    throw InvalidInput(fmt::format(
        "map_surface: the surfaces have {} components; only one in one piece can be mapped",
        components));
  }
  compare("border loops", static_cast<int>(boundary_loops(source).size()),
          static_cast<int>(boundary_loops(target).size()));
  compare("handles (by the Euler characteristic)", euler_characteristic(source),
          euler_characteristic(target));
}

// Returns true if points lie nearly in a line.
bool in_line(const Eigen::Matrix3Xd& points) {
  const Eigen::MatrixXd offsets = points.colwise() - points.rowwise().mean().eval();
  const Eigen::VectorXd spread = offsets.jacobiSvd().singularValues();
  return !(spread[1] > kInLine * spread[0]);
}

// Projects the landmarks of one side onto its surface.
std::vector<SurfacePoint> place_landmarks(Eigen::Matrix3Xd& points, const SurfaceQuery& surface,
                                          double max_distance, const char* side) {
  std::vector<SurfacePoint> places;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const ClosestPoint place = surface.closest_point(points.col(k));
    if (!(place.distance <= max_distance)) {
      throw InvalidInput(
          fmt::format("map_surface: landmark {} of the {} is {} mm from the surface; at most {} mm "
                      "are allowed. Check that landmarks and surface are in one frame and unit",
                      k, side, place.distance, max_distance));
    }
    points.col(k) = place.position;
    places.push_back(place.at);
  }
  if (in_line(points)) {
    throw InvalidInput(
        fmt::format("map_surface: the landmarks of the {} lie nearly in a line (or at a point), so "
                    "the rotation about it is not known; add one beside it",
                    side));
  }
  return places;
}

void check_landmarks(const Landmarks& landmarks) {
  if (landmarks.source.cols() != landmarks.target.cols() || landmarks.source.cols() < 3) {
    throw InvalidInput(fmt::format(
        "map_surface: {} landmarks of the source and {} of the target; at least three pairs are "
        "needed",
        landmarks.source.cols(), landmarks.target.cols()));
  }
  for (Eigen::Index k = 0; k < landmarks.source.cols(); ++k) {
    if (landmarks.source.col(k).allFinite() && landmarks.target.col(k).allFinite()) continue;
    throw InvalidInput(fmt::format("map_surface: landmark {} is not finite", k));
  }
}

/// Computes the target position of each vertex. Border vertices are attracted to the border.
class Attractor {
 public:
  Attractor(const TriangleMesh& source, const TriangleMesh& target, const SurfaceQuery& surface)
      : triangles_(source.triangles), surface_(surface), normals_(triangle_normals(target)) {
    is_border_.resize(static_cast<std::size_t>(source.vertices.cols()), false);
    for (const std::vector<int>& loop : boundary_loops(source))
      for (const int v : loop) is_border_[static_cast<std::size_t>(v)] = true;
    for (const std::vector<int>& loop : boundary_loops(target)) {
      for (std::size_t i = 0; i < loop.size(); ++i)
        border_edges_.emplace_back(target.vertices.col(loop[i]),
                                   target.vertices.col(loop[(i + 1) % loop.size()]));
    }
  }

  [[nodiscard]] bool is_border(Eigen::Index v) const {
    return is_border_[static_cast<std::size_t>(v)] && !border_edges_.empty();
  }

  /// The target of each vertex. A vertex that only faces the back of the surface stays.
  [[nodiscard]] Eigen::Matrix3Xd targets(const Eigen::Matrix3Xd& positions) const {
    const ClosestPoints closest = closest_points(surface_, positions);
    const Eigen::Matrix3Xd facing = vertex_normals({positions, triangles_});
    Eigen::Matrix3Xd result = closest.positions;
    for (Eigen::Index v = 0; v < positions.cols(); ++v) {
      if (is_border(v)) {
        result.col(v) = nearest_on_border(positions.col(v));
      } else if (normals_.col(closest.triangles[v]).dot(facing.col(v)) < 0) {
        result.col(v) = positions.col(v);
      }
    }
    return result;
  }

  [[nodiscard]] Eigen::Vector3d nearest_on_border(const Eigen::Vector3d& point) const {
    Eigen::Vector3d nearest = point;
    double least = kInfinity;
    for (const auto& [a, b] : border_edges_) {
      const Eigen::Vector3d along = b - a;
      const double length = along.squaredNorm();
      const double t = length > 0 ? std::clamp((point - a).dot(along) / length, 0.0, 1.0) : 0;
      const Eigen::Vector3d on_edge = a + t * along;
      const double distance = (point - on_edge).squaredNorm();
      if (distance >= least) continue;
      least = distance;
      nearest = on_edge;
    }
    return nearest;
  }

 private:
  Eigen::Matrix3Xi triangles_;
  const SurfaceQuery& surface_;
  Eigen::Matrix3Xd normals_;
  std::vector<bool> is_border_;
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> border_edges_;
};

Eigen::Matrix3Xd fit_to_target(const TriangleMesh& source, const std::vector<SurfacePoint>& pinned,
                               const Landmarks& landmarks, const Attractor& attractor) {
  Eigen::Matrix3Xd positions = warp_by_landmarks(source.vertices, landmarks);
  const TriangleMesh rest{positions, source.triangles};
  const double diagonal = bounding_diagonal(rest);
  ElasticSurface elastic(rest, pinned);
  Eigen::VectorXd weights(positions.cols());
  for (Eigen::Index v = 0; v < weights.size(); ++v)
    weights[v] = attractor.is_border(v) ? kBorderWeight : 1;
  for (int level = 0; level < kElasticLevels; ++level) {
    const double fall = static_cast<double>(level) / (kElasticLevels - 1);
    elastic.factorise(diagonal * kFirstLength * std::pow(kLastLength / kFirstLength, fall),
                      weights);
    for (int round = 0; round < kElasticRounds; ++round) {
      const Eigen::Matrix3Xd before = positions;
      elastic.relax(attractor.targets(positions), landmarks.target, positions);
      if ((positions - before).cwiseAbs().maxCoeff() <= kRoundingMove * diagonal) break;
    }
  }
  return attractor.targets(positions);
}

// Columns: two edges of a triangle and its unit normal; the area is half its determinant.
Eigen::Matrix3d triangle_basis(const Eigen::Matrix3Xd& vertices, const Eigen::Vector3i& t) {
  Eigen::Matrix3d basis;
  basis.col(0) = vertices.col(t[1]) - vertices.col(t[0]);
  basis.col(1) = vertices.col(t[2]) - vertices.col(t[0]);
  basis.col(2) = basis.col(0).cross(basis.col(1)).stableNormalized();
  return basis;
}

double area_of(const Eigen::Matrix3d& basis) { return basis.col(0).cross(basis.col(1)).norm() / 2; }

// The gradient of a triangle's map, which maps its normal to the image's; NaN without an area.
Eigen::Matrix3d gradient(const Eigen::Matrix3d& from, const Eigen::Matrix3d& to) {
  if (!(area_of(from) > 0)) return Eigen::Matrix3d::Constant(kNan);
  return to * from.inverse();
}

void measure_distortion(const TriangleMesh& source, const TriangleMesh& target,
                        const SurfaceQuery& surface, SurfaceMap& map) {
  const Eigen::Index count = source.triangles.cols();
  const Eigen::Matrix3Xd normals = triangle_normals(target);
  map.singular_values.setConstant(2, count, kNan);
  map.folded.setConstant(count, false);
  double area = 0, image_area = 0, folded_area = 0, folded_image = 0;
  for (Eigen::Index t = 0; t < count; ++t) {
    const Eigen::Matrix3d from = triangle_basis(source.vertices, source.triangles.col(t));
    const Eigen::Matrix3d to = triangle_basis(map.positions, source.triangles.col(t));
    if (!(area_of(from) > 0)) continue;
    const Eigen::Matrix<double, 3, 2> edges = gradient(from, to) * from.leftCols<2>();
    // Express the edges in an orthonormal basis of the source's triangle.
    const Eigen::Vector3d u = from.col(0).normalized();
    const Eigen::Vector3d w = from.col(2).cross(u);
    Eigen::Matrix2d planar;
    planar << u.dot(from.col(0)), u.dot(from.col(1)), w.dot(from.col(0)), w.dot(from.col(1));
    map.singular_values.col(t) = (edges * planar.inverse()).eval().jacobiSvd().singularValues();
    const Eigen::Vector3d middle =
        map.positions(Eigen::all, source.triangles.col(t)).rowwise().mean();
    const Eigen::Vector3d outward = normals.col(surface.closest_point(middle).at.triangle);
    map.folded[t] = !(area_of(to) > 0) || to.col(2).dot(outward) < 0;
    area += area_of(from);
    image_area += area_of(to);
    if (map.folded[t]) {
      folded_area += area_of(from);
      folded_image += area_of(to);
    }
  }
  double target_area = 0;
  for (const auto& t : target.triangles.colwise())
    target_area += area_of(triangle_basis(target.vertices, t));
  map.scale = std::sqrt(image_area / area);
  map.folded_share = folded_area / area;
  map.coverage = (image_area - folded_image) / target_area;
}

void judge(const TriangleMesh& source, const SurfaceMapOptions& options, SurfaceMap& map) {
  const Eigen::ArrayXd larger = map.singular_values.row(0), smaller = map.singular_values.row(1);
  map.area_distortion = larger * smaller / (map.scale * map.scale);
  map.angle_distortion = larger / smaller;
  map.distorted.setConstant(larger.size(), false);
  double area = 0, bad = 0;
  for (Eigen::Index t = 0; t < larger.size(); ++t) {
    const double share = area_of(triangle_basis(source.vertices, source.triangles.col(t)));
    if (!(share > 0)) continue;
    area += share;
    const double stretch = map.area_distortion[t];
    const bool fine = !map.folded[t] && stretch <= options.max_area_distortion &&
                      stretch >= 1 / options.max_area_distortion &&
                      map.angle_distortion[t] <= options.max_angle_distortion;
    map.distorted[t] = !fine;
    if (!fine) bad += share;
  }
  map.distorted_share = bad / area;
  map.reason = fmt::format(
      "{:.2g} % of the area is distorted (area by more than {:g}, or directions by more than {:g}, "
      "or folded), {:.2g} % folded; the image covers {:.1f} % of the target; landmarks are met to "
      "{:.3g} mm",
      100 * map.distorted_share, options.max_area_distortion, options.max_angle_distortion,
      100 * map.folded_share, 100 * map.coverage, map.landmark_rms);
  map.verdict = map.distorted_share > options.max_bad_share ? SurfaceMapVerdict::not_sensible
                : map.distorted_share > 0                   ? SurfaceMapVerdict::distorted
                                                            : SurfaceMapVerdict::sensible;
}

}  // namespace

void visit(SurfaceMapOptions& options, FieldVisitor& visitor) {
  visitor.begin("SurfaceMapOptions");
  visitor.real(
      {"max_bad_share", "Reject a map that distorts or folds more than this share of the area"},
      options.max_bad_share, at_least(0).at_most(1));
  constexpr bool kExpert = true;
  visitor.real({"max_area_distortion",
                "A triangle is distorted if its area is stretched by more than this factor, "
                "relative to the whole surface, or by less than one over it",
                "", kExpert},
               options.max_area_distortion, above(1));
  visitor.real({"max_angle_distortion",
                "A triangle is distorted if one direction is stretched by more than this factor "
                "relative to the perpendicular one",
                "", kExpert},
               options.max_angle_distortion, above(1));
  visitor.real({"max_landmark_distance",
                "Refuse a landmark that is farther from its surface, as a share of the diagonal of "
                "the surface",
                "", kExpert},
               options.max_landmark_distance, above(0));
}

SurfaceMap map_surface(const TriangleMesh& source, const TriangleMesh& target,
                       const Landmarks& landmarks, const SurfaceMapOptions& options) {
  static_cast<void>(in_range(options));
  check_topology(source, target);
  check_landmarks(landmarks);
  const SurfaceQuery from(source), to(target);
  Landmarks placed = landmarks;
  const std::vector<SurfacePoint> pinned = place_landmarks(
      placed.source, from, options.max_landmark_distance * bounding_diagonal(source), "source");
  place_landmarks(placed.target, to, options.max_landmark_distance * bounding_diagonal(target),
                  "target");
  SurfaceMap map;
  map.positions =
      closest_points(to, fit_to_target(source, pinned, placed, {source, target, to})).positions;
  const TriangleMesh image{map.positions, source.triangles};
  double squares = 0;
  for (std::size_t k = 0; k < pinned.size(); ++k) {
    const Eigen::Vector3d off =
        position(image, pinned[k]) - placed.target.col(static_cast<Eigen::Index>(k));
    squares += off.squaredNorm();
  }
  map.landmark_rms = std::sqrt(squares / static_cast<double>(pinned.size()));
  measure_distortion(source, target, to, map);
  judge(source, options, map);
  return map;
}

std::vector<Eigen::Matrix3d> local_rotations(const TriangleMesh& source, const SurfaceMap& map) {
  std::vector<Eigen::Matrix3d> sums(static_cast<std::size_t>(source.vertices.cols()),
                                    Eigen::Matrix3d::Zero());
  for (const auto& t : source.triangles.colwise()) {
    const Eigen::Matrix3d from = triangle_basis(source.vertices, t);
    const Eigen::Matrix3d to = triangle_basis(map.positions, t);
    if (!(area_of(from) > 0) || !(area_of(to) > 0)) continue;
    for (const int v : t) sums[static_cast<std::size_t>(v)] += area_of(from) * gradient(from, to);
  }
  for (Eigen::Matrix3d& sum : sums) sum = nearest_rotation(sum);
  return sums;
}

Eigen::VectorXd vertex_means(const TriangleMesh& mesh,
                             const Eigen::Ref<const Eigen::VectorXd>& values) {
  if (values.size() != mesh.triangles.cols()) {
    throw InvalidInput(fmt::format("vertex_means: {} values for {} triangles", values.size(),
                                   mesh.triangles.cols()));
  }
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(mesh.vertices.cols());
  Eigen::VectorXd areas = sums;
  for (Eigen::Index t = 0; t < values.size(); ++t) {
    const double area = area_of(triangle_basis(mesh.vertices, mesh.triangles.col(t)));
    if (!std::isfinite(values[t]) || !(area > 0)) continue;
    for (const int v : mesh.triangles.col(t)) {
      sums[v] += area * values[t];
      areas[v] += area;
    }
  }
  return sums.cwiseQuotient(areas);
}

const char* to_string(SurfaceMapVerdict verdict) {
  switch (verdict) {
    case SurfaceMapVerdict::sensible:
      return "sensible";
    case SurfaceMapVerdict::distorted:
      return "distorted";
    case SurfaceMapVerdict::not_sensible:
      return "not_sensible";
  }
  return "unknown";
}

}  // namespace palpate::geometry
