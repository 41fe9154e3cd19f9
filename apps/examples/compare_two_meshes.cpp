// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// Compares two surfaces over their whole area and not at their vertices alone. Needs a mesh:
// compare_two_meshes hand.ply. The other mesh is the same one smoothed. Prints the Hausdorff
// distance both ways and the mean and root mean square of the signed distances.
#include <palpate/core/error.h>
#include <palpate/geometry/mesh_distance.h>
#include <palpate/geometry/mesh_io.h>
#include <palpate/geometry/smoothing.h>

#include <cstdio>

namespace geometry = palpate::geometry;

int main(int count, char** arguments) try {
  if (count != 2) throw palpate::InvalidInput("usage: compare_two_meshes MESH");
  const geometry::TriangleMesh mesh = geometry::read_mesh(arguments[1]);
  const geometry::TriangleMesh smooth = geometry::smooth(mesh);

  const geometry::HausdorffDistance worst = geometry::hausdorff_distance(smooth, mesh);
  std::printf("smooth to mesh: no point further than %.3f mm, one at least %.3f mm away\n",
              worst.a_to_b.upper, worst.a_to_b.lower);
  std::printf("mesh to smooth: no point further than %.3f mm, one at least %.3f mm away\n",
              worst.b_to_a.upper, worst.b_to_a.lower);
  const geometry::SurfaceDistances all = geometry::surface_distances(smooth, mesh);
  std::printf("over %.0f mm^2: mean %.4f mm, root mean square %.4f mm\n", all.area, all.mean,
              all.rms);
} catch (const palpate::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
