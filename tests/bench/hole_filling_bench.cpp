// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Hole filling against CGAL's bare call on a surface that is already in CGAL's own structure and
// whose holes are known: the time, and whether the patches are the same.
#include "palpate/geometry/hole_filling.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <chrono>
#include <iterator>
#include <limits>
#include <vector>

#include "mesh_corpus.h"
#include "paired.h"
#include "palpate/geometry/cgal_mesh.h"
#include "test_surfaces.h"

namespace {

namespace geometry = palpate::geometry;
namespace processing = CGAL::Polygon_mesh_processing;
using geometry::TriangleMesh;
using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;

/// The mesh without the triangles near points of a lattice.
TriangleMesh perforated(const TriangleMesh& mesh, double spacing, double radius) {
  std::vector<int> kept;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const Eigen::Matrix3d corners = mesh.vertices(Eigen::all, mesh.triangles.col(t));
    const Eigen::Array3d at = corners.rowwise().mean().array() / spacing;
    if (spacing * (at - at.round()).matrix().norm() > radius) kept.push_back(t);
  }
  return {mesh.vertices, mesh.triangles(Eigen::all, kept)};
}

void against_cgal(benchmark::State& state, const TriangleMesh& mesh) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const Surface open = geometry::to_surface_mesh<Point>(mesh);
  std::vector<Surface::Halfedge_index> loops;
  processing::extract_boundary_cycles(open, std::back_inserter(loops));
  geometry::FilledMesh ours;
  Surface filled;
  double copying = 0;
  palpate::bench::run_paired(
      state, [&] { ours = geometry::fill_holes(mesh, {.max_diameter = kInfinity}); },
      [&] {
        copying += palpate::bench::seconds([&] { filled = open; });
        std::vector<Surface::Face_index> faces;
        std::vector<Surface::Vertex_index> vertices;
        for (const auto border : loops) {
          processing::triangulate_refine_and_fair_hole(filled, border, std::back_inserter(faces),
                                                       std::back_inserter(vertices));
        }
      });
  const TriangleMesh peer = geometry::from_surface_mesh(filled);
  const bool alike = ours.mesh.vertices.cols() == peer.vertices.cols() &&
                     ours.mesh.triangles.cols() == peer.triangles.cols();
  state.counters["holes"] = ours.filled;
  state.counters["triangles"] = static_cast<double>(mesh.triangles.cols());
  state.counters["added"] = static_cast<double>(ours.mesh.triangles.cols() - mesh.triangles.cols());
  state.counters["copying_ms"] = 1e3 * copying / static_cast<double>(state.iterations());
  state.counters["apart_mm"] =
      alike ? (ours.mesh.vertices - peer.vertices).cwiseAbs().maxCoeff() : kInfinity;
}

BENCHMARK_CAPTURE(against_cgal, sphere_327680_one,
                  perforated(geometry::test::icosphere(7, 50), 50, 5))
    ->Iterations(4)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(against_cgal, sphere_81920_many,
                  perforated(geometry::test::icosphere(6, 50), 20, 3))
    ->Iterations(4)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(against_cgal, range_map_20000, geometry::test::bumpy(20000, 0.25))
    ->Iterations(4)
    ->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(against_cgal, range_map_200000, geometry::test::bumpy(200000, 0.25))
    ->Iterations(2)
    ->Unit(benchmark::kMillisecond);

}  // namespace
