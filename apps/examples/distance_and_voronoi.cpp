// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
//
// Distances along a surface, and the part of it that is nearest to each of some places. Needs a
// mesh: distance_and_voronoi hand.ply. Prints how far the furthest vertex is from its place, and
// how many vertices each place has.
#include <palpate/core/error.h>
#include <palpate/geometry/geodesic_distance.h>
#include <palpate/geometry/mesh_io.h>

#include <cstdio>
#include <vector>

namespace geometry = palpate::geometry;

int main(int count, char** arguments) try {
  if (count != 2) throw palpate::InvalidInput("usage: distance_and_voronoi MESH");
  const geometry::TriangleMesh mesh = geometry::read_mesh(arguments[1]);

  // Five places, each the middle of a triangle, spread over the list of triangles.
  std::vector<geometry::SurfacePoint> places;
  for (int i = 0; i < 5; ++i) {
    const auto triangle = static_cast<int>(i * mesh.triangles.cols() / 5);
    places.push_back({triangle, Eigen::Vector3d::Constant(1.0 / 3)});
  }
  const geometry::GeodesicDistance field = geometry::geodesic_distance(mesh, places);

  // A vertex that no way leads to is infinitely far and has the label -1.
  const auto reached = (field.label.array() >= 0).count();
  const double furthest = (field.label.array() >= 0).select(field.distance, 0).maxCoeff();
  std::printf("%ld of %ld vertices reached, the furthest over %.1f mm\n",
              static_cast<long>(reached), static_cast<long>(field.label.size()), furthest);
  for (int i = 0; i < 5; ++i) {
    std::printf("place %d: %ld vertices\n", i,
                static_cast<long>((field.label.array() == i).count()));
  }
} catch (const palpate::Error& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
