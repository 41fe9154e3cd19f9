// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CGAL/Surface_mesh.h>

#include <array>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/triangle_mesh.h"

/// \file
/// Conversion to and from CGAL's Surface_mesh. No other header of Palpate includes this one or
/// needs CGAL to compile; link CGAL::CGAL yourself.
///
/// Both directions copy, since CGAL's triangles are halfedges; `cgal_views.h` has views of points
/// and property maps.
namespace palpate::geometry {

/// Converts a mesh. Vertices and triangles keep their order, so indices stay valid.
/// \tparam Point  point type of the wanted kernel, constructible from three doubles.
/// \throws InvalidInput if the mesh is not valid, or naming the triangle at which it is not
/// manifold.
template <class Point>
[[nodiscard]] CGAL::Surface_mesh<Point> to_surface_mesh(const TriangleMesh& mesh) {
  check_mesh(mesh, "mesh");
  using Surface = CGAL::Surface_mesh<Point>;
  using Vertex = typename Surface::Vertex_index;
  Surface surface;
  const auto vertices = static_cast<typename Surface::size_type>(mesh.vertices.cols());
  const auto triangles = static_cast<typename Surface::size_type>(mesh.triangles.cols());
  surface.reserve(vertices, vertices + triangles, triangles);
  for (const auto& v : mesh.vertices.colwise()) surface.add_vertex(Point(v.x(), v.y(), v.z()));
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto corner = [&](int k) {
      return Vertex(static_cast<typename Surface::size_type>(mesh.triangles(k, t)));
    };
    if (surface.add_face(corner(0), corner(1), corner(2)) == Surface::null_face()) {
      throw InvalidInput(
          "mesh: triangle " + std::to_string(t) +
          " makes it non-manifold: an edge would have a second triangle on one side, "
          "or a vertex a second fan");
    }
  }
  return surface;
}

/// Converts a mesh. Vertices and triangles keep their order; removed ones are skipped.
/// \throws InvalidInput naming a face that is not a triangle, or if `check_mesh` fails.
template <class Point>
[[nodiscard]] TriangleMesh from_surface_mesh(const CGAL::Surface_mesh<Point>& surface) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(surface.number_of_vertices()));
  mesh.triangles.resize(3, static_cast<Eigen::Index>(surface.number_of_faces()));
  std::vector<int> index(surface.num_vertices(), -1);  // removed vertices counted too
  int v = 0;
  for (const auto vertex : surface.vertices()) {
    const Point& p = surface.point(vertex);
    mesh.vertices.col(v) << CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z());
    index[vertex] = v++;
  }
  Eigen::Index t = 0;
  for (const auto face : surface.faces()) {
    int k = 0;
    for (const auto vertex : surface.vertices_around_face(surface.halfedge(face))) {
      if (k < 3) mesh.triangles(k, t) = index[vertex];
      ++k;
    }
    if (k != 3) {
      throw InvalidInput("surface mesh: face " + std::to_string(static_cast<unsigned>(face)) +
                         " has " + std::to_string(k) + " corners, not 3: triangulate it first");
    }
    ++t;
  }
  check_mesh(mesh, "surface mesh");
  return mesh;
}

}  // namespace palpate::geometry
