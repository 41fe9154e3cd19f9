// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/geodesic_surface.h"

#include <gmock/gmock.h>

#include <array>
#include <cmath>
#include <optional>
#include <thread>
#include <vector>

#include "palpate/geometry/geodesic_distance.h"
#include "palpate/geometry/geodesic_path.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using ::testing::HasSubstr;

TriangleMesh waves() {
  TriangleMesh sheet = test::flat_sheet(30, 25, 1.3);
  for (auto at : sheet.vertices.colwise()) at.z() = 3 * std::sin(at.x() / 4) * std::cos(at.y() / 5);
  return sheet;
}

TEST(GeodesicSurface, GivesInAllCallsAndThreadsWhatTheMeshGivesInOne) {
  const TriangleMesh mesh = waves();
  const std::vector<SurfacePoint> from = vertex_points(mesh, std::array{17}),
                                  to = vertex_points(mesh, std::array{500, 731});
  const GeodesicSurface surface(mesh);
  for (const GeodesicMethod method : {GeodesicMethod::fast_marching, GeodesicMethod::exact}) {
    const Eigen::VectorXd expected = geodesic_distance(mesh, from, {.method = method}).distance;
    std::vector<Eigen::VectorXd> found(4);
    std::vector<std::thread> threads;
    for (Eigen::VectorXd& distance : found)
      threads.emplace_back([&distance, &from, method, copy = surface] {
        distance = geodesic_distance(copy, from, {.method = method}).distance;
      });
    for (std::thread& thread : threads) thread.join();
    for (const Eigen::VectorXd& distance : found) EXPECT_EQ(distance, expected);
  }
  const auto expected = shortest_paths(mesh, from, to), found = shortest_paths(surface, from, to);
  for (std::size_t i = 0; i < to.size(); ++i) {
    EXPECT_EQ(found[i]->length, expected[i]->length);
    EXPECT_EQ(straighten_path(surface, found[i]->points).length,
              straighten_path(mesh, expected[i]->points).length);
  }
}

TEST(GeodesicSurface, RefusesInEachCallWhatOnlyExactDistancesCannotPass) {
  TriangleMesh mesh = waves();
  mesh.triangles.conservativeResize(3, mesh.triangles.cols() + 1);
  mesh.triangles.rightCols(1) = mesh.triangles.col(40);  // each of its edges gets a third triangle
  const std::vector<SurfacePoint> from = vertex_points(mesh, std::array{17});
  const GeodesicSurface surface(mesh);
  for (int call = 0; call < 2; ++call) {
    EXPECT_THAT(refusal([&] {
                  return geodesic_distance(surface, from, {.method = GeodesicMethod::exact});
                }),
                HasSubstr("edge"));
    EXPECT_TRUE(geodesic_distance(surface, from).distance.allFinite());
  }
}

TEST(GeodesicSurface, RefusesAMeshThatIsNotValid) {
  TriangleMesh mesh = waves();
  mesh.triangles(1, 5) = -1;
  EXPECT_THAT(refusal([&] { return GeodesicSurface(mesh); }), HasSubstr("triangle 5"));
}

}  // namespace
}  // namespace palpate::geometry
