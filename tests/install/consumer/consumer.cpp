// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// A cube with an edge of 2 mm: how far from its surface is a point 2 mm from its centre?
#include <palpate/geometry/surface_query.h>
#include <cstdio>

int main() {
  palpate::geometry::TriangleMesh cube;
  cube.vertices.resize(3, 8);
  for (int i = 0; i < 8; ++i)
    cube.vertices.col(i) << (i & 1 ? 1 : -1), (i & 2 ? 1 : -1), (i & 4 ? 1 : -1);
  cube.triangles.resize(3, 12);
  cube.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      2, 3, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,                //
      3, 1, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  const palpate::geometry::SurfaceQuery query(cube);
  std::printf("%ld triangles, %.3f mm away\n", static_cast<long>(cube.triangles.cols()),
              query.closest_point({2, 0.1, 0.2}).distance);
}
