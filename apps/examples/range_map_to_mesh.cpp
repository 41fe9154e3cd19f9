// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// A range map becomes a mesh. Needs nothing: the map is that of a ball before a wall, one pixel of
// it unknown. Prints how many triangles there are, that ball and wall are two surfaces, and writes
// ball.ply to look at.
#include <palpate/core/error.h>
#include <palpate/geometry/mesh_io.h>
#include <palpate/geometry/mesh_topology.h>
#include <palpate/geometry/range_map_mesh.h>

#include <cmath>
#include <cstdio>
#include <limits>

namespace geometry = palpate::geometry;

int main() try {
  geometry::RangeMap map;
  map.camera = {.width = 320, .height = 240, .fx = 380, .fy = 380, .cx = 159.5, .cy = 119.5};
  map.z = geometry::ImageF::Constant(240, 320, 700);  // mm
  const Eigen::Vector3d centre(10, -5, 560);
  const double radius = 60;
  for (int v = 0; v < 240; ++v) {
    for (int u = 0; u < 320; ++u) {
      const Eigen::Vector3d ray((u - map.camera.cx) / map.camera.fx,
                                (v - map.camera.cy) / map.camera.fy, 1);
      const double a = ray.squaredNorm();
      const double b = ray.dot(centre);
      const double root = b * b - a * (centre.squaredNorm() - radius * radius);
      if (root > 0) map.z(v, u) = static_cast<float>((b - std::sqrt(root)) / a);
    }
  }
  map.z(20, 30) = std::numeric_limits<float>::quiet_NaN();

  const geometry::RangeMapMesh surface = geometry::mesh_range_map(map);
  std::printf("%ld vertices, %ld triangles in %d surfaces; vertex 0 is pixel %d\n",
              static_cast<long>(surface.mesh.vertices.cols()),
              static_cast<long>(surface.mesh.triangles.cols()),
              geometry::connected_components(surface.mesh).count, surface.source[0]);
  geometry::write_mesh("ball.ply", surface.mesh);
} catch (const palpate::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
