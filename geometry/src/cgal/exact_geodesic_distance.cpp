// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/geodesic_methods.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <unordered_map>
#include <vector>

#include "base/numbers.h"
#include "palpate/error.h"
#include "palpate/geometry/cgal_mesh.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<Kernel::Point_3>;
using Traits = CGAL::Surface_mesh_shortest_path_traits<Kernel, CgalMesh>;
using ShortestPath = CGAL::Surface_mesh_shortest_path<Traits>;

/// A triangle is out of reach iff it is farther than the radius by more than this fraction of
/// radius and size: above the rounding of the few operations that compute it.
constexpr double kReachRounding = 1e-12;

void refuse_triangles_without_area(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xd normals = triangle_normals(mesh);
  for (Eigen::Index t = 0; t < normals.cols(); ++t) {
    if (normals.col(t).allFinite()) continue;
    throw InvalidInput("geodesic_distance: triangle " + std::to_string(t) +
                       " has no area, which GeodesicMethod::exact cannot pass; remove it or use "
                       "GeodesicMethod::fast_marching");
  }
}

/// The triangles that a path of length `radius` can touch: it stays in the balls around its
/// sources.
std::vector<int> within_reach(const TriangleMesh& mesh, std::span<const SurfacePoint> sources,
                              double radius) {
  Eigen::Matrix3Xd from(3, static_cast<Eigen::Index>(sources.size()));
  for (size_t i = 0; i < sources.size(); ++i) {
    from.col(static_cast<Eigen::Index>(i)) = position(mesh, sources[i]);
  }
  std::vector<int> reached;
  reached.reserve(static_cast<size_t>(mesh.triangles.cols()));
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    if (radius == kInfinity) {
      reached.push_back(t);
      continue;
    }
    const Eigen::Matrix3d corners = mesh.vertices(Eigen::all, mesh.triangles.col(t));
    const Eigen::Vector3d centre = corners.rowwise().mean();
    const double size = (corners.colwise() - centre).colwise().norm().maxCoeff();
    const double nearest = (from.colwise() - centre).colwise().norm().minCoeff();
    if (nearest <= (radius + size) * (1 + kReachRounding)) reached.push_back(t);
  }
  return reached;
}

/// Vertices are perturbed by up to this fraction of the mean edge length. If paths tie exactly, as
/// through the vertices of a flat grid, CGAL's rounding may discard all of them, and the result is
/// several percent too long; in general position it is accurate to twelve digits.
constexpr double kOutOfTies = 1e-9;

double mean_edge_length(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& corners : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      sum += (mesh.vertices.col(corners[(k + 1) % 3]) - mesh.vertices.col(corners[k])).norm();
    }
  }
  return sum / static_cast<double>(mesh.triangles.size());
}

/// The vertices, slightly perturbed, always in the same way.
Eigen::Matrix3Xd in_general_position(const TriangleMesh& mesh) {
  std::mt19937 random(1);
  const double largest = kOutOfTies * mean_edge_length(mesh);
  Eigen::Matrix3Xd vertices = mesh.vertices;
  for (double& coordinate : vertices.reshaped()) {
    const double fraction = static_cast<double>(random()) / std::mt19937::max();  // in [0, 1]
    coordinate += largest * (2 * fraction - 1);
  }
  return vertices;
}

/// Input of CGAL: all vertices, and the triangles within reach.
struct Part {
  CgalMesh mesh;
  std::vector<int> face_of;  ///< T; -1 if out of reach
};

Part reachable_part(const TriangleMesh& mesh, std::span<const SurfacePoint> sources,
                    double radius) {
  // Reject the mesh as a whole, independently of the radius.
  (void)to_surface_mesh<Kernel::Point_3>(mesh);
  const std::vector<int> reached = within_reach(mesh, sources, radius);
  const TriangleMesh reached_mesh{.vertices = in_general_position(mesh),
                                  .triangles = mesh.triangles(Eigen::all, reached)};
  Part part{.mesh = to_surface_mesh<Kernel::Point_3>(reached_mesh),
            .face_of = std::vector(static_cast<size_t>(mesh.triangles.cols()), -1)};
  for (size_t i = 0; i < reached.size(); ++i) {
    part.face_of[static_cast<size_t>(reached[i])] = static_cast<int>(i);
  }
  return part;
}

/// A place on a face in CGAL's convention: barycentric coordinates in the order of the corners from
/// the face's half-edge on.
ShortestPath::Face_location face_location(const TriangleMesh& mesh, const Part& part,
                                          const SurfacePoint& place) {
  const CgalMesh::Face_index face(
      static_cast<CgalMesh::size_type>(part.face_of[static_cast<size_t>(place.triangle)]));
  const CgalMesh::Vertex_index first = part.mesh.source(part.mesh.halfedge(face));
  int k = 0;
  while (mesh.triangles(k, place.triangle) != static_cast<int>(first.idx())) ++k;
  const Eigen::Vector3d& weights = place.barycentric;
  return {face, {weights[k], weights[(k + 1) % 3], weights[(k + 2) % 3]}};
}

/// The same place without slightly negative coordinates due to rounding.
SurfacePoint rounded(const SurfacePoint& place) {
  const Eigen::Vector3d weights = place.barycentric.cwiseMax(0);
  return {.triangle = place.triangle, .barycentric = weights / weights.sum()};
}

/// Replaces zero for places on an edge: positive, but without effect on the result.
constexpr double kAlmostZero = std::numeric_limits<double>::min();

/// CGAL's starting points for one source. CGAL 5.5 confuses the ends of an edge that contains a
/// source (it uses the weight of one end as the distance from it), so a place on an edge becomes
/// one place in each of the two adjacent triangles.
std::vector<SurfacePoint> starts(const Eigen::Matrix3Xi& opposite, const SurfacePoint& source) {
  SurfacePoint start = rounded(source);
  if ((start.barycentric.array() > 0).count() != 2) return {start};
  Eigen::Index apex = 0;
  start.barycentric.minCoeff(&apex);
  start.barycentric[apex] = kAlmostZero;
  const int across = opposite((apex + 1) % 3, start.triangle);
  if (across < 0) return {start};
  // Corner k of the other triangle corresponds to corner apex + 2 of this one.
  const int k = across % 3;
  SurfacePoint other{.triangle = across / 3};
  other.barycentric[k] = start.barycentric[(apex + 2) % 3];
  other.barycentric[(k + 1) % 3] = start.barycentric[(apex + 1) % 3];
  other.barycentric[(k + 2) % 3] = kAlmostZero;
  return {start, other};
}

/// Preconditions: those of `exact_geodesic_distance`; triangles have an area.
GeodesicDistance measure(const TriangleMesh& mesh, std::span<const SurfacePoint> sources,
                         double stop_radius) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  const Part part = reachable_part(mesh, sources, stop_radius);
  ShortestPath shortest(part.mesh);
  std::unordered_map<const ShortestPath::Face_location*, int> label_of;
  for (size_t i = 0; i < sources.size(); ++i) {
    for (const SurfacePoint& start : starts(opposite, sources[i])) {
      label_of[&*shortest.add_source_point(face_location(mesh, part, start))] = static_cast<int>(i);
    }
  }
  shortest.build_sequence_tree();
  GeodesicDistance geodesic{.distance = Eigen::VectorXd::Constant(mesh.vertices.cols(), kInfinity),
                            .label = Eigen::VectorXi::Constant(mesh.vertices.cols(), -1)};
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    const CgalMesh::Vertex_index vertex(static_cast<CgalMesh::size_type>(v));
    const auto [distance, source] = shortest.shortest_distance_to_source_points(vertex);
    // Negative: not reached.
    if (!(distance >= 0 && distance <= stop_radius)) continue;
    geodesic.distance[v] = distance;
    geodesic.label[v] = label_of.at(&*source);
  }
  return geodesic;
}

}  // namespace

GeodesicDistance exact_geodesic_distance(const TriangleMesh& mesh,
                                         std::span<const SurfacePoint> sources,
                                         double stop_radius) {
  refuse_triangles_without_area(mesh);
  try {
    return measure(mesh, sources, stop_radius);
  } catch (const CGAL::Failure_exception& failure) {
    throw SolverError(std::string("geodesic_distance: GeodesicMethod::exact failed; use "
                                  "GeodesicMethod::fast_marching: ") +
                      failure.what());
  }
}

}  // namespace palpate::geometry
