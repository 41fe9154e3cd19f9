// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_shortest_path.h>

#include <limits>
#include <random>
#include <span>
#include <unordered_map>

#include "palpate/geometry/cgal_mesh.h"
#include "palpate/geometry/geodesic_distance.h"

/// Exact geodesic distances by CGAL, to compare with. Needs CGAL's GPL packages.
namespace palpate::geometry::test {

/// Vertices are perturbed by up to this fraction of the mean edge length. If paths tie exactly, as
/// through the vertices of a flat grid, CGAL's rounding may discard all of them, and the result is
/// several percent too long.
inline constexpr double kCgalPerturbation = 1e-9;

inline TriangleMesh in_general_position(TriangleMesh mesh) {
  double sum = 0;
  for (const auto& corners : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      sum += (mesh.vertices.col(corners[(k + 1) % 3]) - mesh.vertices.col(corners[k])).norm();
    }
  }
  const double largest = kCgalPerturbation * sum / static_cast<double>(mesh.triangles.size());
  std::mt19937 random(1);
  std::uniform_real_distribution<double> by(-largest, largest);
  for (double& coordinate : mesh.vertices.reshaped()) coordinate += by(random);
  return mesh;
}

/// Chen and Han 1990, improved by Xin and Wang 2009. Precondition: the mesh is manifold, with
/// triangles that have an area, and the sources are not on edges (CGAL 5.5 confuses their ends).
inline GeodesicDistance cgal_geodesic_distance(const TriangleMesh& mesh,
                                               std::span<const SurfacePoint> sources) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Surface = CGAL::Surface_mesh<Kernel::Point_3>;
  using ShortestPath =
      CGAL::Surface_mesh_shortest_path<CGAL::Surface_mesh_shortest_path_traits<Kernel, Surface>>;
  const Surface surface = to_surface_mesh<Kernel::Point_3>(in_general_position(mesh));
  ShortestPath shortest(surface);
  std::unordered_map<const ShortestPath::Face_location*, int> label_of;
  for (size_t i = 0; i < sources.size(); ++i) {
    const SurfacePoint& source = sources[i];
    const Surface::Face_index face(static_cast<Surface::size_type>(source.triangle));
    // CGAL counts the corners from that of the face's half-edge on.
    const auto first = static_cast<int>(surface.source(surface.halfedge(face)).idx());
    int k = 0;
    while (mesh.triangles(k, source.triangle) != first) ++k;
    const auto& weights = source.barycentric;
    const auto added =
        shortest.add_source_point(face, {weights[k], weights[(k + 1) % 3], weights[(k + 2) % 3]});
    label_of[&*added] = static_cast<int>(i);
  }
  shortest.build_sequence_tree();
  constexpr double kUnreached = std::numeric_limits<double>::infinity();
  GeodesicDistance geodesic{.distance = Eigen::VectorXd::Constant(mesh.vertices.cols(), kUnreached),
                            .label = Eigen::VectorXi::Constant(mesh.vertices.cols(), -1)};
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    const Surface::Vertex_index vertex(static_cast<Surface::size_type>(v));
    const auto [distance, source] = shortest.shortest_distance_to_source_points(vertex);
    if (!(distance >= 0)) continue;  // negative: not reached
    geodesic.distance[v] = distance;
    geodesic.label[v] = label_of.at(&*source);
  }
  return geodesic;
}

}  // namespace palpate::geometry::test
