// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// The shortest program on palpate::geometry; README.md shows it. Needs a mesh: decimate_a_mesh
// hand.ply. Prints the verified distance between the mesh and one with fewer triangles, which it
// writes to decimated.ply.
#include <palpate/geometry/decimation.h>
#include <palpate/geometry/mesh_io.h>

#include <iostream>

int main(int count, char** arguments) {
  if (count < 2) {
    std::cerr << "usage: decimate_a_mesh MESH\n";
    return 2;
  }
  using namespace palpate::geometry;
  const TriangleMesh mesh = read_mesh(arguments[1]);
  const Decimation small = decimate(mesh, {.tolerance = 0.2});  // mm
  std::cout << small.distance << " mm apart at most\n";
  write_mesh("decimated.ply", small.mesh);
}
