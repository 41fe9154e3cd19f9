// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/geometry/surface_query.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

Eigen::Matrix3Xd places(int count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  return Eigen::Matrix3Xd::NullaryExpr(3, count, [&](auto, auto) { return uniform(random); });
}

struct PlainHit {
  double fraction;
  int triangle;
};

/// All crossings by Cramer's rule on every triangle.
std::vector<PlainHit> hits_of_every_triangle(const TriangleMesh& mesh, const Vector3d& start,
                                             const Vector3d& end) {
  std::vector<PlainHit> hits;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    const Vector3d a = mesh.vertices.col(mesh.triangles(0, t));
    Eigen::Matrix3d equations;
    equations << mesh.vertices.col(mesh.triangles(1, t)) - a,
        mesh.vertices.col(mesh.triangles(2, t)) - a, start - end;
    const Vector3d vwt = equations.fullPivLu().solve(start - a);
    if (vwt.minCoeff() >= 0 && vwt[0] + vwt[1] <= 1 && vwt[2] <= 1) hits.push_back({vwt[2], t});
  }
  std::ranges::sort(hits, {}, &PlainHit::fraction);
  return hits;
}

/// +1 where a line leaves the surface through the triangle, -1 where it enters.
int side(const TriangleMesh& mesh, int triangle, const Vector3d& along) {
  const Eigen::Matrix3d corners = mesh.vertices(Eigen::all, mesh.triangles.col(triangle));
  const Vector3d normal = (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
  return normal.dot(along) > 0 ? 1 : -1;
}

/// Expects that crossings lead in and out in turns, and out at the end. Two at a fold may be
/// equally far within rounding; their order says nothing.
void expect_in_and_out(const TriangleMesh& mesh, const std::vector<SegmentHit>& hits,
                       const Vector3d& along) {
  constexpr double kAsFar = 1e-13;
  EXPECT_EQ(hits.size() % 2, 0U);
  int in = 0;
  for (std::size_t i = 0; i < hits.size(); ++i) {
    in -= side(mesh, hits[i].at.triangle, along);
    const bool next_as_far =
        i + 1 < hits.size() && hits[i + 1].fraction - hits[i].fraction < kAsFar;
    if (next_as_far) continue;
    EXPECT_EQ(in, i % 2 == 0 ? 1 : 0) << i;
  }
  EXPECT_EQ(in, 0);
}

TEST(AllHits, EqualASearchThroughAllTriangles) {
  const TriangleMesh mesh = test::random_triangles(300, 30, 11);
  const SurfaceQuery query(mesh);
  const Eigen::Matrix3Xd starts = places(300, 60, 12), ends = places(300, 60, 13);
  std::size_t most = 0;
  for (int i = 0; i < 300; ++i) {
    const auto expected = hits_of_every_triangle(mesh, starts.col(i), ends.col(i));
    const auto found = query.all_hits(starts.col(i), ends.col(i));
    const Vector3d along = ends.col(i) - starts.col(i);
    const auto on_ray = query.all_hits(
        {.origin = starts.col(i), .direction = 0.3 * along, .max_distance = along.norm()});
    ASSERT_EQ(found.size(), expected.size());
    ASSERT_EQ(on_ray.size(), expected.size());
    for (std::size_t k = 0; k < found.size(); ++k) {
      EXPECT_EQ(found[k].at.triangle, expected[k].triangle);
      EXPECT_NEAR(found[k].fraction, expected[k].fraction, 1e-12);
      EXPECT_EQ(found[k].position, position(mesh, found[k].at));
      EXPECT_EQ(on_ray[k].at.triangle, expected[k].triangle);
      EXPECT_NEAR(on_ray[k].distance, expected[k].fraction * along.norm(), 1e-9);
    }
    const auto first = query.first_hit(starts.col(i), ends.col(i));
    EXPECT_EQ(first ? first->at.triangle : -1, found.empty() ? -1 : found.front().at.triangle);
    most = std::max(most, found.size());
  }
  EXPECT_GE(most, 3U);
}

// Rays aimed at vertices and at points of edges, from vertices opposite, and along the axes.
TEST(AllHits, AlternateInAndOutThroughEdgesAndVerticesOfClosedSurfaces) {
  for (const TriangleMesh& mesh :
       {test::icosphere(2, 10.7), test::scaled(test::icosphere(1, 1), 0x1p30),
        test::moved(test::glove(9.1), Eigen::Isometry3d(Eigen::Translation3d(1e5, 0, -3e4)))}) {
    const SurfaceQuery query(mesh);
    const double size = bounding_diagonal(mesh);
    const Vector3d middle =
        (mesh.vertices.rowwise().minCoeff() + mesh.vertices.rowwise().maxCoeff()) / 2;
    std::vector<Vector3d> aims;
    for (int t = 0; t < mesh.triangles.cols();
         t += 1 + static_cast<int>(mesh.triangles.cols()) / 90) {
      const Vector3d a = mesh.vertices.col(mesh.triangles(0, t));
      const Vector3d b = mesh.vertices.col(mesh.triangles(1, t));
      aims.insert(aims.end(), {a, (a + b) / 2, 0.75 * a + 0.25 * b});
    }
    int hit = 0;
    for (std::size_t i = 0; i < aims.size(); ++i) {
      const Vector3d from =
          middle + 2 * size * (aims[(7 * i + 3) % aims.size()] - middle).normalized();
      for (const Vector3d& along : {Vector3d(2 * (aims[i] - from)), Vector3d(0, 0, 4 * size),
                                    Vector3d(4 * size, 4 * size, 0)}) {
        const Vector3d start =
            along.z() == 0 || along.x() == 0 ? Vector3d(aims[i] - along / 2) : from;
        const auto hits = query.all_hits(start, start + along);
        expect_in_and_out(mesh, hits, along);
        if (!hits.empty()) ++hit;
      }
    }
    EXPECT_GT(hit, static_cast<int>(2 * aims.size()));
  }
}

TEST(AllHits, CountASheetOnceAtItsInnerEdgesAndVertices) {
  const TriangleMesh sheet = test::flat_sheet(6, 6, 0.7);
  const SurfaceQuery query(sheet);
  for (int v = 0; v < sheet.vertices.cols(); ++v) {
    for (const Vector3d& offset :
         {Vector3d(0, 0, 0), Vector3d(0.35, 0, 0), Vector3d(0.35, 0.35, 0)}) {
      const Vector3d at = sheet.vertices.col(v) + offset;
      const bool inside = at.x() > 0 && at.y() > 0 && at.x() < 4.19 && at.y() < 4.19;
      const bool outside = at.x() > 4.21 || at.y() > 4.21;
      for (const Vector3d& along : {Vector3d(0, 0, 2), Vector3d(0.1, -0.3, -2)}) {
        const auto hits = query.all_hits(at - along, at + along);
        if (inside) {
          ASSERT_EQ(hits.size(), 1U);
          EXPECT_DOUBLE_EQ(hits[0].fraction, 0.5);
        } else {
          EXPECT_LE(hits.size(), outside ? 0U : 1U);  // at the border one or none
        }
      }
    }
  }
}

TEST(AllHits, IncludeEndsOnTheSurfaceAndNothingBeyond) {
  const TriangleMesh sphere = test::icosphere(2, 10.7);
  const SurfaceQuery query(sphere);
  for (int t = 0; t < sphere.triangles.cols(); ++t) {
    const Vector3d on = position(sphere, {t, {0.2, 0.3, 0.5}});
    const auto through = query.all_hits({.origin = on, .direction = -on});
    ASSERT_EQ(through.size(), 2U);
    EXPECT_EQ(through[0].at.triangle, t);
    EXPECT_NEAR(through[0].distance, 0, 1e-14);
    EXPECT_EQ(query.all_hits({.origin = on, .direction = -on, .max_distance = 0}).size(), 1U);
    EXPECT_EQ(query.all_hits({.origin = 1.001 * on, .direction = on}).size(), 0U);
    const auto outwards = query.all_hits(0.5 * on, on);
    ASSERT_EQ(outwards.size(), 1U);
    EXPECT_NEAR(outwards[0].fraction, 1, 1e-14);
    EXPECT_EQ(query.all_hits(on, on).size(), 1U);
  }
  EXPECT_TRUE(query.all_hits({0, 0, 0}, {0, kNaN, 20}).empty());
  EXPECT_TRUE(query.all_hits({.origin = {0, 0, 0}, .direction = {0, 0, 0}}).empty());
}

TEST(AllHits, OfManySegmentsAreThoseOfEach) {
  const TriangleMesh mesh = test::random_triangles(300, 30, 14);
  const SurfaceQuery query(mesh);
  Eigen::Matrix3Xd starts = places(500, 40, 15);
  const Eigen::Matrix3Xd ends = places(500, 40, 16);
  starts(1, 7) = kNaN;
  const AllHits all = all_hits(query, starts, ends);
  Eigen::Index k = 0;
  for (int i = 0; i < 500; ++i) {
    for (const SegmentHit& hit : query.all_hits(starts.col(i), ends.col(i))) {
      ASSERT_LT(k, all.segments.size());
      EXPECT_EQ(all.segments[k], i);
      EXPECT_EQ(all.triangles[k], hit.at.triangle);
      EXPECT_EQ(all.barycentric.col(k), hit.at.barycentric);
      EXPECT_EQ(all.positions.col(k), hit.position);
      EXPECT_EQ(all.along[k], hit.fraction);
      ++k;
    }
  }
  EXPECT_EQ(k, all.along.size());
  EXPECT_GT(k, 200);
  EXPECT_FALSE((all.segments.array() == 7).any());
  EXPECT_THROW((void)all_hits(query, starts, ends.leftCols(9)), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
