// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Memory that goes from this program to the library and back: what one of them allocates, the other
// resizes and frees.
#include <palpate/geometry/decimation.h>
#include <palpate/geometry/mesh_io.h>
#include <palpate/geometry/smoothing.h>

#include <Eigen/Geometry>
#include <cstdio>
#include <vector>

namespace geometry = palpate::geometry;

namespace {

geometry::TriangleMesh grid(int side) {
  geometry::TriangleMesh mesh;
  mesh.vertices.resize(3, (side + 1) * (side + 1));
  for (int i = 0; i < mesh.vertices.cols(); ++i)
    mesh.vertices.col(i) << i % (side + 1), i / (side + 1), 0;
  mesh.triangles.resize(3, 2 * side * side);
  for (int cell = 0; cell < side * side; ++cell) {
    const int a = cell / side * (side + 1) + cell % side;
    mesh.triangles.col(2 * cell) << a, a + 1, a + side + 2;
    mesh.triangles.col(2 * cell + 1) << a, a + side + 2, a + side + 1;
  }
  return mesh;
}

}  // namespace

int main(int, char** arguments) {
  const Eigen::Isometry3d turned(Eigen::AngleAxisd(0.5, Eigen::Vector3d(1, 2, 3).normalized()));
  std::vector<Eigen::Isometry3d> poses(3, turned);
  for (int side = 1; side < 40; ++side) {
    geometry::MeshFile file{.mesh = grid(side)};
    geometry::write_mesh_file(arguments[1], file);
    file = geometry::read_mesh_file(arguments[1]);
    file.mesh.vertices = (poses[1] * file.mesh.vertices).eval();
    file.mesh.vertices.conservativeResize(3, file.mesh.vertices.cols() + 7);
    file.mesh.vertices.rightCols(7).setConstant(1e3);
    geometry::TriangleMesh mesh = geometry::smooth(file.mesh, {.iterations = 1});
    mesh.vertices = grid(side).vertices;
    geometry::Decimation decimated = geometry::decimate(mesh, {.tolerance = 0.01});
    decimated.mesh.triangles.resize(3, 1);
  }
  std::puts("every vertex came back");
}
