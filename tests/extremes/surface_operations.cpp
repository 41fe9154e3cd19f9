// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <numeric>
#include <span>

#include "operations.h"
#include "palpate/geometry/contact_locator.h"
#include "palpate/geometry/contact_triangulation.h"
#include "palpate/geometry/cross_section.h"
#include "palpate/geometry/curvature.h"
#include "palpate/geometry/decimation.h"
#include "palpate/geometry/edge_splitting.h"
#include "palpate/geometry/facing_share.h"
#include "palpate/geometry/farthest_points.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/geometry/geodesic_path.h"
#include "palpate/geometry/hole_filling.h"
#include "palpate/geometry/mesh_defects.h"
#include "palpate/geometry/mesh_distance.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_repair.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/motion_smoothing.h"
#include "palpate/geometry/remeshing.h"
#include "palpate/geometry/self_intersection_removal.h"
#include "palpate/geometry/self_intersections.h"
#include "palpate/geometry/smoothing.h"
#include "palpate/geometry/surface_map.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/surface_strain.h"
#include "palpate/geometry/winding_number.h"

namespace palpate::extremes {
namespace {

using namespace geometry;
using Eigen::Vector3d;

/// Inputs of geodesics and paths: the first contacts are sources, the others targets.
constexpr std::size_t kSources = 2;

/// A sheet that has been stretched and bent a little, for what compares two surfaces.
TriangleMesh bent(const Input& input) {
  TriangleMesh mesh = input.sheet;
  const Eigen::Isometry3d back = input.place.inverse();
  for (auto vertex : mesh.vertices.colwise()) {
    // Along the object's own axes, whose origin `place` moves.
    const Vector3d local =
        (back.linear() * (vertex - input.place.translation())) / (input.length * input.extent);
    const double lift = 0.01 * local.x() * local.y() / 8;
    vertex += input.length * (input.place.linear() * Vector3d(0.03 * local.x(), 0, lift));
  }
  return mesh;
}

Eigen::VectorXd vertex_numbers(const std::vector<int>& indices, Eigen::Index count) {
  Eigen::VectorXd chosen = Eigen::VectorXd::Zero(count);
  for (const int i : indices) chosen[i] = 1;
  return chosen;
}

Results measures(const Input& input, const Change&) {
  const MeshShape shape = mesh_shape(input.sheet);
  return {number("area", surface_area(input.sheet), kArea),
          number("volume", enclosed_volume(input.ball), kVolume),
          number("edges", static_cast<double>(shape.edges)),
          number("longest edge", shape.longest_edge, kLength),
          number("median edge", shape.median_edge, kLength),
          number("smallest angle", shape.smallest_angle),
          number("components", connected_components(input.sheet).count)};
}

Results normals(const Input& input, const Change&) {
  check_mesh(input.sheet, "sheet");  // which the functions require
  return {unknown_allowed(vectors("of triangles", triangle_normals(input.sheet), kNumber,
                                  &Order::sheet_triangles)),
          unknown_allowed(vectors("of vertices", vertex_normals(input.sheet), kNumber,
                                  &Order::sheet_vertices))};
}

Results defects(const Input& input, const Change&) {
  return {number("of the sheet", static_cast<double>(find_all_defects(input.sheet).size())),
          number("of the ball", static_cast<double>(find_all_defects(input.ball).size()))};
}

Results repair(const Input& input, const Change&) {
  const RepairedMesh repaired = repair_mesh(input.sheet);
  return {number("area", surface_area(repaired.mesh), kArea),
          number("vertices", static_cast<double>(repaired.mesh.vertices.cols()))};
}

Results holes(const Input& input, const Change& change) {
  HoleFillingOptions options{.max_diameter = 30 * input.length};
  change(fields_of(options));
  const FilledMesh filled = fill_holes(input.sheet, options);
  return {number("filled", filled.filled), number("area", surface_area(filled.mesh), kArea)};
}

Results smoothing(const Input& input, const Change& change) {
  SmoothingOptions options;
  change(fields_of(options));
  return {places("vertices", smooth(input.sheet, options).vertices, &Order::sheet_vertices)};
}

Results curvature(const Input& input, const Change&) {
  const VertexCurvature found = vertex_curvature(input.ball);
  return {unknown_allowed(numbers("mean", found.mean, kPerLength, &Order::ball_vertices)),
          unknown_allowed(numbers("gaussian", found.gaussian, kPerArea, &Order::ball_vertices))};
}

Results section(const Input& input, const Change&) {
  const Plane plane{input.place * Vector3d(0, 28.3 * input.length, 0),
                    input.place.linear() * Vector3d(0.1, 1, 0.05)};
  double length = 0;
  const std::vector<Polyline> lines = cross_section(input.sheet, plane);
  for (const Polyline& line : lines)
    for (Eigen::Index i = 1; i < line.cols(); ++i) length += (line.col(i) - line.col(i - 1)).norm();
  return {number("length", length, kLength), number("lines", static_cast<double>(lines.size()))};
}

Results closest(const Input& input, const Change&) {
  const ClosestPoints found = closest_points(SurfaceQuery(input.sheet), input.places);
  return {unknown_allowed(numbers("distances", found.distances, kLength, &Order::places)),
          unknown_allowed(places("places", found.positions, &Order::places))};
}

Results rays(const Input& input, const Change&) {
  const SurfaceQuery query(input.ball);
  // From each place through the middle of the ball and as far beyond.
  const Vector3d middle = input.place.translation();
  const Eigen::Matrix3Xd ends = (-input.places).colwise() + 2 * middle;
  const FirstHits first = first_hits(query, input.places, ends);
  const AllHits all = all_hits(query, input.places, ends);
  return {unknown_allowed(numbers("fractions", first.along, kNumber, &Order::places)),
          unknown_allowed(places("first", first.positions, &Order::places)),
          number("hits", static_cast<double>(all.along.size()))};
}

Results winding(const Input& input, const Change&) {
  return {unknown_allowed(numbers("numbers",
                                  winding_numbers(WindingNumber(input.ball), input.places, 1e-3),
                                  kNumber, &Order::places, 2e-3))};
}

Results geodesics(const Input& input, GeodesicMethod method) {
  const std::vector<SurfacePoint> contacts = contacts_in_order(input);
  const std::span sources(contacts);
  const GeodesicDistance found = geodesic_distance(
      input.sheet, sources.first(std::min(kSources, sources.size())), {.method = method});
  return {
      unknown_allowed(numbers("distances", found.distance, kLength, &Order::sheet_vertices, 1e-9))};
}

Results geodesics_of_each_source(const Input& input, const Change&) {
  const std::vector<SurfacePoint> contacts = contacts_in_order(input);
  const std::span sources(contacts);
  const Eigen::MatrixXd found =
      geodesic_distances(input.sheet, sources.first(std::min(kSources, sources.size())));
  return {unknown_allowed(
      numbers("sums", found.rowwise().sum(), kLength, &Order::sheet_vertices, 1e-9))};
}

Results paths(const Input& input, const Change&) {
  const std::vector<SurfacePoint> contacts = contacts_in_order(input);
  const std::span points(contacts);
  const std::size_t sources = std::min(kSources, points.size());
  Eigen::VectorXd lengths(static_cast<Eigen::Index>(points.size() - sources));
  Eigen::Index i = 0;
  for (const auto& path :
       shortest_paths(input.sheet, points.first(sources), points.subspan(sources)))
    lengths[i++] = path ? path->length : -1;
  std::sort(lengths.begin(), lengths.end());
  return {numbers("lengths", lengths, kLength)};
}

Results straightened(const Input& input, const Change&) {
  const std::vector<SurfacePoint> contacts = contacts_in_order(input);
  const auto paths =
      shortest_paths(input.sheet, std::span(contacts).first(1), std::span(contacts).last(1));
  if (!paths.front()) return {number("length", 0, kLength)};
  return {number("length", straighten_path(input.sheet, paths.front()->points).length, kLength)};
}

Results decimation_to_tolerance(const Input& input, const Change& change) {
  DecimationOptions options{.tolerance = 0.5 * input.length};
  change(fields_of(options));
  const Decimation found = decimate(input.ball, options);
  return {number("distance", found.distance, kLength, kAnything),
          number("triangles", static_cast<double>(found.mesh.triangles.cols()), kNumber, kRoughly),
          number("area", surface_area(found.mesh), kArea, kRoughly)};
}

Results decimation_to_count(const Input& input, const Change& change) {
  DecimationOptions options{.max_triangles = 100};
  change(fields_of(options));
  const Decimation found = decimate(input.ball, options);
  return {number("distance", found.distance, kLength, kAnything),
          number("triangles", static_cast<double>(found.mesh.triangles.cols()), kNumber, kRoughly),
          number("area", surface_area(found.mesh), kArea, kRoughly)};
}

Results hausdorff(const Input& input, const Change&) {
  const HausdorffDistance found = hausdorff_distance(input.sheet, bent(input), {.max_gap = 0.05});
  return {number("lower", found.lower, kLength, 0.1), number("upper", found.upper, kLength, 0.1)};
}

Results between_surfaces(const Input& input, const Change&) {
  const SurfaceDistances found = surface_distances(input.sheet, bent(input), {.cells = 2000});
  return {number("mean", found.mean, kLength), number("rms", found.rms, kLength),
          number("area", found.area, kArea)};
}

Results remeshing(const Input& input, const Change& change) {
  RemeshingOptions options{.edge_length = 5 * input.length, .max_triangles = 100'000};
  change(fields_of(options));
  const Remeshing found = remesh(input.sheet, options);
  return {number("area", surface_area(found.mesh), kArea, kRoughly),
          number("vertices", static_cast<double>(found.mesh.vertices.cols()), kNumber, kRoughly)};
}

Results splitting(const Input& input, const Change&) {
  const double longest = 6.5 * input.length;
  const SplitMesh split = split_edges(input.sheet, [&](const Vector3d& from, const Vector3d& to) {
    return (to - from).norm() > longest;
  });
  return {number("vertices", static_cast<double>(split.mesh.vertices.cols())),
          number("area", surface_area(split.mesh), kArea)};
}

Results farthest(const Input& input, const Change&) {
  std::vector<int> candidates(static_cast<std::size_t>(input.sheet.vertices.cols()));
  std::iota(candidates.begin(), candidates.end(), 0);
  const FarthestPoints found =
      farthest_points(input.sheet, candidates, {.spacing = 15 * input.length});
  return {numbers("chosen", vertex_numbers(found.vertices, input.sheet.vertices.cols()), kNumber,
                  &Order::sheet_vertices),
          number("cover", found.cover.empty() ? 0 : found.cover.back(), kLength)};
}

Results facing(const Input& input, const Change&) {
  const Vector3d direction = input.place.linear() * Vector3d(0.2, -0.4, 0.9);
  const auto count = static_cast<Eigen::Index>(input.contacts.size());
  return {unknown_allowed(numbers(
      "shares",
      facing_shares(input.sheet, input.contacts, direction.replicate(1, count), 10 * input.length),
      kNumber, &Order::contacts))};
}

Results strain(const Input& input, const Change&) {
  const SurfaceStrain found = surface_strain(input.sheet, bent(input).vertices, 8 * input.length);
  return {unknown_allowed(numbers("largest", found.largest, kNumber, &Order::sheet_vertices)),
          unknown_allowed(numbers("area", found.area, kNumber, &Order::sheet_vertices))};
}

/// A sheet that bends ever faster, and trembles.
Results motion_smoothing(const Input& input, const Change&) {
  const Eigen::Matrix3Xd bending = bent(input).vertices - input.sheet.vertices;
  std::vector<Eigen::Matrix3Xd> frames;
  std::vector<double> times;
  for (int i = 0; i < 8; ++i) {
    times.push_back(i / 30.0);
    const double share = i * i * i / 512.0 + 0.5 * (i % 2);
    frames.push_back(input.sheet.vertices + share * bending);
  }
  const SmoothedMotion found = smooth_motion(frames, times, times[3], 0.1);
  return {places("positions", found.positions, &Order::sheet_vertices),
          numbers("sigma", found.sigma, kLength, &Order::sheet_vertices)};
}

/// Two sheets through each other.
TriangleMesh crossing(const Input& input) {
  TriangleMesh mesh = input.sheet;
  const Eigen::Index vertices = mesh.vertices.cols(), triangles = mesh.triangles.cols();
  mesh.vertices.conservativeResize(3, 2 * vertices);
  mesh.triangles.conservativeResize(3, 2 * triangles);
  const Vector3d middle = input.place * (input.length * Vector3d(42, 30, 1));
  const Eigen::Matrix3d turn =
      input.place.linear() *
      Eigen::AngleAxisd(0.6, Vector3d(1, 0.3, 0.2).normalized()).toRotationMatrix() *
      input.place.linear().transpose();
  mesh.vertices.rightCols(vertices) =
      (turn * (input.sheet.vertices.colwise() - middle)).colwise() + middle;
  mesh.triangles.rightCols(triangles) = input.sheet.triangles.array() + static_cast<int>(vertices);
  return mesh;
}

Results intersections(const Input& input, const Change&) {
  return {number("triangles", static_cast<double>(intersecting_triangles(crossing(input)).size()))};
}

Results intersection_removal(const Input& input, const Change&) {
  // A spike through the sheet.
  TriangleMesh mesh = input.sheet;
  const int vertex = input.order.sheet_vertices.empty() ? 80 : input.order.sheet_vertices[80];
  if (vertex < mesh.vertices.cols())
    mesh.vertices.col(vertex) += input.place.linear() * (input.length * Vector3d(14.3, 9.1, -2.7));
  const SelfIntersectionRemoval found = remove_self_intersections(mesh);
  return {number("found", found.found), number("left", found.left)};
}

Results triangulation(const Input& input, ContactTriangulationMethod method) {
  const ContactTriangulation found =
      triangulate_contacts(input.sheet, input.contacts, {.method = method});
  const ContactLocator locator(input.sheet, input.contacts, found.weights);
  // Weighted means of all contacts, at each vertex: they do not depend on the order.
  Eigen::Matrix3Xd means = Eigen::Matrix3Xd::Zero(3, input.sheet.vertices.cols());
  const std::vector<SurfacePoint> vertices = vertex_points(input.sheet);
  for (Eigen::Index v = 0; v < means.cols(); ++v) {
    const SurfacePoint& at = vertices[static_cast<std::size_t>(v)];
    if (at.triangle < 0) continue;
    const ContactWeights weights = locator.locate(at);
    for (int k = 0; k < weights.count; ++k) {
      const auto place = static_cast<std::size_t>(k);
      means.col(v) +=
          weights.weights[place] *
          position(input.sheet, input.contacts[static_cast<std::size_t>(weights.contacts[place])]);
    }
  }
  return {number("triangles", static_cast<double>(found.mesh.triangles.cols())),
          number("isolated", static_cast<double>(found.isolated.size())),
          places("means", means, &Order::sheet_vertices)};
}

Results mapping(const Input& input, const Change& change) {
  constexpr double kSolved = 1e-5;  // an iteration ends there
  const TriangleMesh target = bent(input);
  const auto count = static_cast<Eigen::Index>(input.contacts.size());
  Landmarks landmarks{Eigen::Matrix3Xd(3, count), Eigen::Matrix3Xd(3, count)};
  for (Eigen::Index i = 0; i < count; ++i) {
    const SurfacePoint& at = input.contacts[static_cast<std::size_t>(i)];
    check_surface_point(input.sheet, at, "landmark");
    landmarks.source.col(i) = position(input.sheet, at);
    landmarks.target.col(i) = position(target, at);
  }
  SurfaceMapOptions options;
  change(fields_of(options));
  const SurfaceMap map = map_surface(input.sheet, target, landmarks, options);
  return {unknown_allowed(places("positions", map.positions, &Order::sheet_vertices, kSolved)),
          number("scale", map.scale, kNumber, kSolved)};
}

}  // namespace

std::vector<Operation> surface_operations() {
  const auto by = [](auto method, auto call) {
    return [method, call](const Input& input, const Change&) { return call(input, method); };
  };
  return {
      {"mesh measures", kSheet | kBall, measures, 0, 8},
      {"normals", kSheet, normals, 0, 0},
      {"find_all_defects", kSheet | kBall, defects, 0, 0},
      {"repair_mesh", kSheet, repair, 0, 8},
      {"fill_holes", kOptions | kSheet, holes, 0, 8},
      {"smooth", kOptions | kSheet, smoothing, 0, 8},
      {"vertex_curvature", kBall, curvature, 0, 64},
      {"cross_section", kSheet, section, 0, 64},
      {"closest_points", kSheet | kPlaces, closest, 0, 8},
      {"first_hits, all_hits", kBall | kPlaces, rays, 0, 8},
      {"winding_numbers", kBall | kPlaces, winding, 0, 8},
      {"geodesic_distance: fast_marching", kSheet | kContacts,
       by(GeodesicMethod::fast_marching, geodesics), 0, 8},
      {"geodesic_distance: exact", kSheet | kContacts, by(GeodesicMethod::exact, geodesics), 0, 8},
      {"geodesic_distances", kSheet | kContacts, geodesics_of_each_source, 0, 8},
      {"shortest_paths", kSheet | kContacts, paths, 0, 8},
      {"straighten_path", kSheet | kContacts, straightened, 0, 8},
      {"decimate: tolerance", kOptions | kBall, decimation_to_tolerance, 0, 8},
      {"decimate: max_triangles", kOptions | kBall, decimation_to_count, 0, 8},
      {"hausdorff_distance", kSheet, hausdorff, 0, 64},
      {"surface_distances", kSheet, between_surfaces, 0, 64},
      {"remesh", kOptions | kSheet, remeshing, 0, 8},
      {"split_edges", kSheet, splitting, 0, 8},
      {"farthest_points", kSheet, farthest, 0, 8},
      {"facing_shares", kSheet | kContacts, facing, 0, 8},
      {"surface_strain", kSheet, strain, 0, 64},
      {"smooth_motion", kSheet, motion_smoothing, 0, 512},  // deviations are small beside it
      {"intersecting_triangles", kSheet, intersections, 0, 0},
      {"remove_self_intersections", kSheet, intersection_removal, 0, 0},
      {"triangulate_contacts: delaunay", kSheet | kContacts,
       by(ContactTriangulationMethod::delaunay, triangulation), 0, 8},
      {"triangulate_contacts: voronoi_dual", kSheet | kContacts,
       by(ContactTriangulationMethod::voronoi_dual, triangulation), 0, 8},
      {"map_surface", kOptions | kSheet | kContacts, mapping, 0, 64},
  };
}

}  // namespace palpate::extremes
