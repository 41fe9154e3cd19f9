// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/window_propagation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

std::size_t window_count(const FlatTriangles& flat, const WindowPropagation& propagation) {
  std::size_t count = 0;
  for (int edge = 0; edge < flat.edge_count; ++edge) count += propagation.windows(edge).size();
  return count;
}

TEST(WindowPropagation, WithoutTargetsDropsAllWindowsAndKeepsTheDistances) {
  TriangleMesh sheet = test::flat_sheet(60, 50, 1.3);
  for (auto at : sheet.vertices.colwise()) at.z() = 4 * std::sin(at.x() / 7) * std::cos(at.y() / 5);
  const FlatTriangles flat = flat_triangles(sheet);
  const std::vector<SurfacePoint> vertices = vertex_points(sheet);
  WindowPropagation dropping(flat, kInfinity), keeping(flat, kInfinity);
  for (WindowPropagation* propagation : {&dropping, &keeping}) {
    propagation->start({.triangle = 1001, .barycentric = {0.2, 0.3, 0.5}}, 0);
    propagation->start({.triangle = 4200, .barycentric = {0, 0.6, 0.4}}, 1);
  }
  dropping.run({});
  keeping.run_to(vertices);
  EXPECT_EQ(window_count(flat, dropping), 0U);
  EXPECT_GT(window_count(flat, keeping), static_cast<std::size_t>(flat.edge_count));
  for (int v = 0; v < sheet.vertices.cols(); ++v) {
    ASSERT_EQ(dropping.distance(v), keeping.distance(v)) << "vertex " << v;
    ASSERT_EQ(dropping.source(v), keeping.source(v)) << "vertex " << v;
  }
}

}  // namespace
}  // namespace palpate::geometry
