// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/hole_filling.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/connected_components.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <cmath>
#include <iterator>
#include <string>
#include <vector>

#include "palpate/error.h"
#include "palpate/geometry/cgal_mesh.h"
#include "palpate/require.h"

namespace palpate::geometry {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
// CGAL searches patches in a Delaunay tetrahedralisation, which needs exact predicates.
using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;

/// A border loop is the outline of its component, and no hole in it, iff the bounding box of the
/// component is at most this many times as large. That of a hemisphere is 1.06 times as large.
constexpr double kOutline = 1.05;

/// [mm]
double diagonal(const CGAL::Bbox_3& box) {
  return Eigen::Vector3d(box.x_span(), box.y_span(), box.z_span()).norm();
}

/// [mm] diagonal of the bounding box of a border loop.
double diameter(const Surface& surface, Surface::Halfedge_index border) {
  CGAL::Bbox_3 box;
  for (const auto h : CGAL::halfedges_around_face(border, surface))
    box += surface.point(surface.target(h)).bbox();
  return diagonal(box);
}

/// [mm] diagonal of the bounding box of the component of each triangle.
std::vector<double> component_diameters(Surface& surface) {
  const auto component = surface.add_property_map<Surface::Face_index, std::size_t>().first;
  std::vector<CGAL::Bbox_3> boxes(pmp::connected_components(surface, component));
  for (const auto face : surface.faces()) {
    for (const auto vertex : CGAL::vertices_around_face(surface.halfedge(face), surface))
      boxes[component[face]] += surface.point(vertex).bbox();
  }
  std::vector<double> diameters;
  for (const auto face : surface.faces()) diameters.push_back(diagonal(boxes[component[face]]));
  return diameters;
}

bool fill(Surface& surface, Surface::Halfedge_index border) {
  std::vector<Surface::Face_index> faces;
  std::vector<Surface::Vertex_index> vertices;
  try {
    pmp::triangulate_refine_and_fair_hole(surface, border, std::back_inserter(faces),
                                          std::back_inserter(vertices));
  } catch (const CGAL::Failure_exception& failure) {
    const Point& rim = surface.point(surface.target(border));
    throw SolverError("the hole at (" + std::to_string(rim.x()) + ", " + std::to_string(rim.y()) +
                      ", " + std::to_string(rim.z()) +
                      ") mm could not be filled: " + failure.what());
  }
  return !faces.empty();
}

}  // namespace

FilledMesh fill_holes(const TriangleMesh& mesh, const HoleFillingOptions& options) {
  require("HoleFillingOptions::max_diameter", options.max_diameter, above(0), "mm");
  Surface surface = to_surface_mesh<Point>(mesh);
  std::vector<Surface::Halfedge_index> loops;
  pmp::extract_boundary_cycles(surface, std::back_inserter(loops));
  FilledMesh result;
  const std::vector<double> of_component = component_diameters(surface);
  const auto is_hole = [&](Surface::Halfedge_index border) {
    const double width = diameter(surface, border);
    const auto face = static_cast<std::size_t>(surface.face(surface.opposite(border)));
    const bool is_outline = of_component[face] <= kOutline * width;
    return width <= options.max_diameter && (!is_outline || std::isinf(options.max_diameter));
  };
  for (const auto border : loops) {
    if (is_hole(border) && fill(surface, border)) {
      ++result.filled;
    } else {
      ++result.left;
    }
  }
  result.mesh = from_surface_mesh(surface);
  // CGAL may start a triangle at another corner.
  result.mesh.triangles.leftCols(mesh.triangles.cols()) = mesh.triangles;
  return result;
}

}  // namespace palpate::geometry
