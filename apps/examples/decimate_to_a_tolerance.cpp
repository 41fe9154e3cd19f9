// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// Decimates a surface to the fewest triangles within a tolerance. Needs a mesh:
// decimate_to_a_tolerance hand.ply. Prints the size of the mesh for some tolerances with the
// distance that was verified, and writes small.ply, the last of them.
#include <palpate/core/error.h>
#include <palpate/geometry/decimation.h>
#include <palpate/geometry/mesh_io.h>

#include <cstdio>

namespace geometry = palpate::geometry;

int main(int count, char** arguments) try {
  if (count != 2) throw palpate::InvalidInput("usage: decimate_to_a_tolerance MESH");
  const geometry::TriangleMesh mesh = geometry::read_mesh(arguments[1]);
  std::printf("%ld triangles\n", static_cast<long>(mesh.triangles.cols()));
  geometry::Decimation small;
  for (const double tolerance : {0.1, 0.3, 1.0}) {  // mm
    small = geometry::decimate(mesh, {.tolerance = tolerance});
    std::printf("within %.1f mm: %ld triangles, none of the surface further than %.3f mm away\n",
                tolerance, static_cast<long>(small.mesh.triangles.cols()), small.distance);
  }
  geometry::write_mesh("small.ply", small.mesh);
} catch (const palpate::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
