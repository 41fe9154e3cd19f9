// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Isotropic remeshing against CGAL's, with the same edge length, iterations and features: time,
// lengths of edges, angles, and the distance from the input. CGAL splits and collapses edges along
// features and the border, and so moves them; ours stay.
#include "palpate/geometry/remeshing.h"

#include <CGAL/Polygon_mesh_processing/detect_features.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>

#include <algorithm>
#include <numbers>
#include <string>
#include <vector>

#include "mesh_corpus.h"
#include "paired.h"
#include "palpate/geometry/mesh_distance.h"
#include "palpate/geometry/mesh_measures.h"
#include "test_surfaces.h"

namespace {

namespace geometry = palpate::geometry;
using geometry::TriangleMesh;
constexpr double kDegrees = 180 / std::numbers::pi;

TriangleMesh cgal_remesh(const TriangleMesh& mesh, double length) {
  using Surface = CGAL::Surface_mesh<CGAL::Simple_cartesian<double>::Point_3>;
  namespace processing = CGAL::Polygon_mesh_processing;
  namespace parameters = processing::parameters;
  Surface surface;
  for (const auto& v : mesh.vertices.colwise()) surface.add_vertex({v.x(), v.y(), v.z()});
  for (const auto& t : mesh.triangles.colwise()) {
    surface.add_face(Surface::Vertex_index(static_cast<unsigned>(t[0])),
                     Surface::Vertex_index(static_cast<unsigned>(t[1])),
                     Surface::Vertex_index(static_cast<unsigned>(t[2])));
  }
  auto sharp = surface.add_property_map<Surface::Edge_index, bool>("e:sharp", false).first;
  processing::detect_sharp_edges(surface, 60, sharp);
  processing::isotropic_remeshing(surface.faces(), length, surface,
                                  parameters::number_of_iterations(10)
                                      .edge_is_constrained_map(sharp)
                                      .number_of_relaxation_steps(1));
  surface.collect_garbage();
  TriangleMesh result;
  result.vertices.resize(3, surface.number_of_vertices());
  for (const auto v : surface.vertices()) {
    const auto& p = surface.point(v);
    result.vertices.col(static_cast<Eigen::Index>(v.idx())) << p.x(), p.y(), p.z();
  }
  result.triangles.resize(3, surface.number_of_faces());
  for (const auto f : surface.faces()) {
    int k = 0;
    for (const auto v : surface.vertices_around_face(surface.halfedge(f)))
      result.triangles(k++, static_cast<Eigen::Index>(f.idx())) = static_cast<int>(v);
  }
  return result;
}

/// Share of the triangles with an angle below 30 degrees.
double share_of_thin(const TriangleMesh& mesh) {
  int thin = 0;
  for (const auto& t : mesh.triangles.colwise()) {
    double least = std::numbers::pi;
    for (int k = 0; k < 3; ++k) {
      const Eigen::Vector3d at = mesh.vertices.col(t[k]);
      const Eigen::Vector3d a = mesh.vertices.col(t[(k + 1) % 3]) - at;
      const Eigen::Vector3d b = mesh.vertices.col(t[(k + 2) % 3]) - at;
      least = std::min(least, std::atan2(a.cross(b).norm(), a.dot(b)));
    }
    thin += least * kDegrees < 30 ? 1 : 0;
  }
  return thin / static_cast<double>(mesh.triangles.cols());
}

/// Share of the edges within a fifth of the length, and within the range that is neither split nor
/// collapsed.
double share_of_edges(const TriangleMesh& mesh, double low, double high) {
  int inside = 0;
  for (const auto& t : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const double edge = (mesh.vertices.col(t[k]) - mesh.vertices.col(t[(k + 1) % 3])).norm();
      inside += edge >= low && edge <= high ? 1 : 0;
    }
  }
  return inside / static_cast<double>(mesh.triangles.size());
}

void count(benchmark::State& state, const std::string& whose, const TriangleMesh& input,
           const TriangleMesh& mesh, double length) {
  const geometry::MeshShape shape = geometry::mesh_shape(mesh);
  state.counters[whose + "_triangles"] = static_cast<double>(mesh.triangles.cols());
  state.counters[whose + "_mean_edge"] = shape.mean_edge / length;
  state.counters[whose + "_fifth"] = share_of_edges(mesh, 0.8 * length, 1.2 * length);
  state.counters[whose + "_range"] = share_of_edges(mesh, 0.8 * length, 4 * length / 3);
  state.counters[whose + "_least_deg"] = shape.smallest_angle * kDegrees;
  state.counters[whose + "_median_deg"] = shape.median_smallest_angle * kDegrees;
  state.counters[whose + "_thin"] = share_of_thin(mesh);
  state.counters[whose + "_mm"] = geometry::hausdorff_distance(input, mesh).upper;
}

void against_cgal(benchmark::State& state, const TriangleMesh& mesh, double length) {
  TriangleMesh ours, peer;
  palpate::bench::run_paired(
      state, [&] { ours = geometry::remesh(mesh, {.edge_length = length}).mesh; },
      [&] { peer = cgal_remesh(mesh, length); });
  count(state, "ours", mesh, ours, length);
  count(state, "peer", mesh, peer, length);
}

BENCHMARK_CAPTURE(against_cgal, sphere_finer, geometry::test::icosphere(4, 50), 2.0)
    ->Iterations(2)
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(against_cgal, sphere_coarser, geometry::test::icosphere(5, 50), 6.0)
    ->Iterations(2)
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(against_cgal, range_map_finer, geometry::test::bumpy(20000, 0.25), 4.0)
    ->Iterations(2)
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(against_cgal, range_map_coarser, geometry::test::bumpy(100000, 0.25), 6.0)
    ->Iterations(2)
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(against_cgal, glove, geometry::test::glove(3.1), 4.0)
    ->Iterations(2)
    ->Unit(benchmark::kSecond);
BENCHMARK_CAPTURE(against_cgal, thin_sheet, geometry::test::closed_sheet(), 2.0)
    ->Iterations(2)
    ->Unit(benchmark::kSecond);

}  // namespace
