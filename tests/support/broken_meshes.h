// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "not_finite.h"
#include "palpate/geometry/mesh_defects.h"
#include "test_surfaces.h"

/// Meshes with exactly one defect, each made from a valid mesh.
namespace palpate::geometry::test {

struct BrokenMesh {
  std::string name;
  TriangleMesh mesh;
  DefectKind kind;
  std::vector<int> elements;  ///< indices of the defective elements
};

/// The mesh with additional triangles.
inline TriangleMesh with_triangles(TriangleMesh mesh, const Eigen::Matrix3Xi& more) {
  const Eigen::Index old = mesh.triangles.cols();
  mesh.triangles.conservativeResize(3, old + more.cols());
  mesh.triangles.rightCols(more.cols()) = more;
  return mesh;
}

inline TriangleMesh with_vertex(TriangleMesh mesh, const Eigen::Vector3d& vertex) {
  mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
  mesh.vertices.rightCols(1) = vertex;
  return mesh;
}

inline std::vector<BrokenMesh> broken_meshes() {
  const TriangleMesh sphere = icosphere(2, 10.1);    // 162 vertices, 320 triangles
  const TriangleMesh sheet = flat_sheet(4, 3, 1.7);  // 20 vertices, 24 triangles
  const auto changed = [](TriangleMesh mesh, auto&& change) {
    change(mesh);
    return mesh;
  };
  std::vector<BrokenMesh> broken = {
      {"vertex not a number",
       changed(sphere, [](auto& m) { m.vertices(1, 17) = kNaN; }),
       DefectKind::infinite_vertex,
       {17}},
      {"vertex infinite",
       changed(sphere, [](auto& m) { m.vertices(0, 161) = -kInf; }),
       DefectKind::infinite_vertex,
       {161}},
      {"corner beyond the last vertex",
       changed(sphere, [](auto& m) { m.triangles(2, 9) = 162; }),
       DefectKind::corner_out_of_range,
       {9}},
      {"corner below zero",
       changed(sphere, [](auto& m) { m.triangles(0, 319) = -1; }),
       DefectKind::corner_out_of_range,
       {319}},
      {"corner twice",
       changed(sphere, [](auto& m) { m.triangles(1, 40) = m.triangles(0, 40); }),
       DefectKind::corner_repeated,
       {40}},
      {"triangle repeated",
       with_triangles(sphere, sphere.triangles.col(5)),
       DefectKind::triangle_repeated,
       {320}},
      {"triangle repeated the other way round",
       with_triangles(sphere, sphere.triangles.col(5).reverse()),
       DefectKind::triangle_repeated,
       {320}},
      {"border triangle turned",
       changed(sheet, [](auto& m) { m.triangles.col(23).reverseInPlace(); }),
       DefectKind::triangle_turned,
       {23}},
      {"vertex alone", with_vertex(sphere, {1, 2, 3}), DefectKind::vertex_isolated, {162}}};

  const int a = sheet.triangles(0, 0), b = sheet.triangles(1, 0);
  broken.push_back(
      {"fin on an inner edge",
       with_triangles(with_vertex(sheet, {1, 1, 5}),
                      Eigen::Vector3i(sheet.triangles(0, 1), sheet.triangles(1, 1), 20)),
       DefectKind::edge_overfull,
       {24}});
  broken.push_back({"two sheets that touch at a corner",
                    with_triangles(with_vertex(with_vertex(sheet, {-1, -0.2, 0}), {-0.2, -1, 0}),
                                   Eigen::Vector3i(0, 20, 21)),
                    DefectKind::vertex_pinched,
                    {0}});
  // A vertex in the middle of the side from a to b, and the triangle between the three.
  broken.push_back(
      {"triangle without area",
       with_triangles(with_vertex(sheet, (sheet.vertices.col(a) + sheet.vertices.col(b)) / 2),
                      Eigen::Vector3i(b, a, 20)),
       DefectKind::triangle_flat,
       {24}});
  broken.push_back(
      {"needle",
       with_triangles(with_vertex(sheet, {1.7 / 2, -1e-4, 0}), Eigen::Vector3i(b, a, 20)),
       DefectKind::triangle_needle,
       {24}});
  return broken;
}

}  // namespace palpate::geometry::test
