// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// For users of CGAL: bounds of the distance between a Surface_mesh and what CGAL's edge collapse
// leaves of it, and the distance of each of its vertices as a property map. Needs a mesh that CGAL
// reads: measure_with_cgal sphere.ply. The edge collapse of CGAL is under the GPL, and so is a
// program that contains it.
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_ratio_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <CGAL/boost/graph/IO/polygon_mesh_io.h>
#include <palpate/core/error.h>
#include <palpate/geometry/cgal_mesh.h>
#include <palpate/geometry/cgal_views.h>
#include <palpate/geometry/mesh_distance.h>

#include <cstdio>

namespace geometry = palpate::geometry;
namespace simplification = CGAL::Surface_mesh_simplification;
using Surface = CGAL::Surface_mesh<CGAL::Simple_cartesian<double>::Point_3>;

int main(int count, char** arguments) try {
  if (count != 2) throw palpate::InvalidInput("usage: measure_with_cgal MESH");
  Surface surface;
  if (!CGAL::IO::read_polygon_mesh(arguments[1], surface))
    throw palpate::FileError(std::string(arguments[1]) + ": CGAL cannot read it as a mesh");
  Surface coarse = surface;
  simplification::edge_collapse(coarse, simplification::Count_ratio_stop_predicate<Surface>(0.2));
  coarse.collect_garbage();

  const geometry::TriangleMesh original = geometry::from_surface_mesh(surface);
  const geometry::HausdorffDistance apart =
      geometry::hausdorff_distance(original, geometry::from_surface_mesh(coarse));
  std::printf("%u of %u triangles; between %.3f and %.3f mm apart\n", coarse.number_of_faces(),
              surface.number_of_faces(), apart.lower, apart.upper);

  // Views of CGAL's property maps, without a copy.
  auto distance = coarse.add_property_map<Surface::Vertex_index, double>("v:distance").first;
  geometry::values_of(distance) =
      geometry::distances_to_surface(geometry::columns_of(coarse.points()), original);
  std::printf("vertices at most %.3f mm from the original\n",
              geometry::values_of(distance).maxCoeff());
  return 0;
} catch (const palpate::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
