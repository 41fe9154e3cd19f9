// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// Rays, many queries at once, and meshes that move.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "dense_sampling.h"
#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/geometry/surface_query.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

/// Relative to the size of the mesh: some tens of double operations, amplified by needles.
constexpr double kRayRounding = 1e-12;

Eigen::Matrix3Xd random_columns(int count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  return Eigen::Matrix3Xd::NullaryExpr(3, count, [&](auto, auto) { return uniform(random); });
}

/// First crossing by Moeller and Trumbore 1997 on every triangle, in multiples of `along`.
double brute_force_crossing(const TriangleMesh& mesh, const Vector3d& start,
                            const Vector3d& along) {
  double first = kInf;
  for (const auto& t : mesh.triangles.colwise()) {
    const Vector3d a = mesh.vertices.col(t[0]);
    const Vector3d ab = mesh.vertices.col(t[1]) - a, ac = mesh.vertices.col(t[2]) - a;
    const double det = ab.dot(along.cross(ac));
    const double v = (start - a).dot(along.cross(ac)) / det;
    const double w = along.dot((start - a).cross(ab)) / det;
    const double place = ac.dot((start - a).cross(ab)) / det;
    if (v >= 0 && w >= 0 && v + w <= 1 && place >= 0) first = std::min(first, place);
  }
  return first;
}

TEST(RayHit, EqualsASearchThroughAllTriangles) {
  const TriangleMesh mesh = test::random_triangles(300, 30, 1);
  const SurfaceQuery query(mesh);
  int hits = 0;
  for (const double size : {5.0, 50.0, 5000.0}) {
    const Eigen::Matrix3Xd origins = random_columns(400, size, 2);
    const Eigen::Matrix3Xd targets = random_columns(400, 30, 3);
    for (int i = 0; i < 400; ++i) {
      const Vector3d along = 0.37 * (targets.col(i) - origins.col(i));
      const double expected = brute_force_crossing(mesh, origins.col(i), along) * along.norm();
      const auto hit = query.first_hit({.origin = origins.col(i), .direction = along});
      ASSERT_EQ(hit.has_value(), expected < kInf);
      if (!hit) continue;
      ++hits;
      EXPECT_NEAR(hit->distance, expected, 10 * kRayRounding * (30 + size));
      EXPECT_EQ(hit->position, position(mesh, hit->at));
      // A distance a little shorter or longer decides whether it is reached.
      Ray ray{.origin = origins.col(i), .direction = along, .max_distance = 0.999 * expected};
      EXPECT_FALSE(query.first_hit(ray).has_value());
      ray.max_distance = 1.001 * expected;
      EXPECT_EQ(query.first_hit(ray).value_or(RayHit{}).at.triangle, hit->at.triangle);
    }
  }
  EXPECT_GT(hits, 300);
}

TEST(RayHit, MeasuresInMillimetresWhateverTheLengthOfTheDirection) {
  const TriangleMesh plane = test::moved(test::flat_sheet(4, 4, 2.5),
                                         Eigen::Isometry3d(Eigen::Translation3d(1e6, -7e5, 1.7)));
  const SurfaceQuery query(plane);
  for (const double length : {1e-300, 1e-9, 1.0, 1e9, 1e300}) {
    const auto hit = query.first_hit(
        {.origin = {1e6 + 3.3, -7e5 + 4.4, 6.7}, .direction = Vector3d(0, 0, -length)});
    ASSERT_TRUE(hit.has_value()) << length;
    EXPECT_NEAR(hit->distance, 5, 1e-15 * 1e6);
    EXPECT_FALSE(query.first_hit(
        {.origin = {1e6 + 3.3, -7e5 + 4.4, 6.7}, .direction = Vector3d(0, 0, length)}));
  }
}

TEST(RayHit, IsAtDistanceZeroOnTheSurface) {
  const TriangleMesh sphere = test::icosphere(2, 10.7);
  const SurfaceQuery query(sphere);
  const Vector3d on = position(sphere, {17, {0.2, 0.3, 0.5}});
  const auto hit = query.first_hit({.origin = on, .direction = on});
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(hit->distance, 0);
  EXPECT_EQ(hit->at.triangle, 17);
  EXPECT_TRUE(query.first_hit({.origin = on, .direction = on, .max_distance = 0}).has_value());
  EXPECT_FALSE(query.first_hit({.origin = 1.001 * on, .direction = on}).has_value());
}

TEST(RayHit, IsNoneForWhatIsNoRay) {
  const SurfaceQuery query(test::icosphere(1, 10));
  const Vector3d up(0, 0, 1);
  EXPECT_TRUE(query.first_hit({.origin = {0, 0, 0}, .direction = up}));
  EXPECT_FALSE(query.first_hit({.origin = {0, 0, 0}, .direction = {0, 0, 0}}));
  EXPECT_FALSE(query.first_hit({.origin = {0, 0, 0}, .direction = up, .max_distance = -1}));
  EXPECT_FALSE(query.first_hit({.origin = {0, 0, 0}, .direction = up, .max_distance = kNaN}));
  for (const double bad : {kNaN, kInf}) {
    EXPECT_FALSE(query.first_hit({.origin = {0, bad, 0}, .direction = up}));
    EXPECT_FALSE(query.first_hit({.origin = {0, 0, 0}, .direction = {1, bad, 0}}));
  }
}

TEST(ManyQueries, AnswerAsOneByOneAndLeaveOutWhatIsNotFinite) {
  const TriangleMesh mesh = test::random_triangles(300, 30, 4);
  const SurfaceQuery query(mesh);
  Eigen::Matrix3Xd starts = random_columns(3000, 40, 5);
  const Eigen::Matrix3Xd ends = random_columns(3000, 40, 6);
  starts(1, 7) = kNaN;
  std::vector<Ray> rays;
  for (int i = 0; i < 3000; ++i) {
    rays.push_back({.origin = starts.col(i), .direction = ends.col(i), .max_distance = 50});
  }
  const ClosestPoints closest = closest_points(query, starts);
  const FirstHits of_segments = first_hits(query, starts, ends);
  const FirstHits of_rays = first_hits(query, rays);
  for (int i = 0; i < 3000; ++i) {
    if (i == 7) continue;
    const ClosestPoint one = query.closest_point(starts.col(i));
    EXPECT_EQ(closest.triangles[i], one.at.triangle);
    EXPECT_EQ(closest.barycentric.col(i), one.at.barycentric);
    EXPECT_EQ(closest.positions.col(i), one.position);
    EXPECT_EQ(closest.distances[i], one.distance);
    const auto segment = query.first_hit(starts.col(i), ends.col(i));
    ASSERT_EQ(of_segments.triangles[i], segment ? segment->at.triangle : -1);
    EXPECT_EQ(std::isnan(of_segments.along[i]), !segment);
    if (segment) {
      EXPECT_EQ(of_segments.along[i], segment->fraction);
      EXPECT_EQ(of_segments.positions.col(i), segment->position);
      EXPECT_EQ(of_segments.barycentric.col(i), segment->at.barycentric);
    }
    const auto ray = query.first_hit(rays[static_cast<std::size_t>(i)]);
    ASSERT_EQ(of_rays.triangles[i], ray ? ray->at.triangle : -1);
    if (ray) {
      EXPECT_EQ(of_rays.along[i], ray->distance);
    }
  }
  EXPECT_EQ(closest.triangles[7], -1);
  EXPECT_TRUE(std::isnan(closest.distances[7]) && closest.positions.col(7).array().isNaN().all());
  EXPECT_EQ(of_segments.triangles[7], -1);
  EXPECT_TRUE(std::isnan(of_segments.along[7]) && std::isnan(of_rays.along[7]));
  EXPECT_EQ(closest_points(query, Eigen::Matrix3Xd(3, 0)).distances.size(), 0);
}

TEST(ManyQueries, RefuseStartsWithoutEnds) {
  const SurfaceQuery query(test::icosphere(1, 10));
  EXPECT_THROW((void)first_hits(query, Eigen::Matrix3Xd::Zero(3, 4), Eigen::Matrix3Xd::Zero(3, 5)),
               InvalidInput);
}

// Marching tetrahedra make needles of any shape, and single precision must not lose one of them.
TEST(ClosestPoint, EqualsASearchThroughAllTrianglesAmongNeedles) {
  TriangleMesh mesh = test::glove(6.3);
  for (const double flat : {1.0, 1e-3, 1e-6}) {
    mesh.vertices.row(2) *= flat;
    const SurfaceQuery query(mesh);
    const test::EveryTriangle triangles(mesh);
    const Eigen::Matrix3Xd points = random_columns(60, 150, 7);
    for (const auto& p : points.colwise()) {
      EXPECT_NEAR(query.closest_point(p).distance, triangles.distance(p, 0, nullptr),
                  kRayRounding * 150);
    }
    for (int t = 0; t < mesh.triangles.cols(); t += 50) {
      const Vector3d near = position(mesh, {t, {0.2, 0.3, 0.5}}) + 1e-4 * points.col(t % 60);
      EXPECT_NEAR(query.closest_point(near).distance, triangles.distance(near, 0, nullptr),
                  kRayRounding * 150);
    }
  }
}

/// Any two queries of the same mesh must answer alike, to the last bit.
void expect_alike(const SurfaceQuery& a, const SurfaceQuery& b, double size) {
  const Eigen::Matrix3Xd starts = random_columns(400, size, 8), ends = random_columns(400, size, 9);
  const ClosestPoints near_a = closest_points(a, starts), near_b = closest_points(b, starts);
  EXPECT_EQ(near_a.triangles, near_b.triangles);
  EXPECT_EQ(near_a.distances, near_b.distances);
  EXPECT_EQ(near_a.positions, near_b.positions);
  const FirstHits hit_a = first_hits(a, starts, ends), hit_b = first_hits(b, starts, ends);
  EXPECT_EQ(hit_a.triangles, hit_b.triangles);
  for (int i = 0; i < 400; ++i) {
    if (hit_a.triangles[i] >= 0) {
      EXPECT_EQ(hit_a.along[i], hit_b.along[i]);
    }
  }
}

TEST(MoveVertices, AnswersAsANewQueryOfTheMovedMesh) {
  TriangleMesh mesh = test::glove(5.1);
  SurfaceQuery moving(mesh);
  const Eigen::Matrix3Xd at_first = mesh.vertices;
  // Bent a little, wildly, turned, far away, flat, and back: refitted and rebuilt.
  const auto expect_follows = [&](const Eigen::Matrix3Xd& vertices, double size) {
    mesh.vertices = vertices;
    moving.move_vertices(vertices);
    expect_alike(moving, SurfaceQuery(mesh), size);
  };
  Eigen::Matrix3Xd bent = at_first;
  for (auto v : bent.colwise()) v.z() += 7.7 * std::sin(0.05 * v.x());
  expect_follows(bent, 150);
  expect_follows(random_columns(static_cast<int>(bent.cols()), 100, 10), 150);
  expect_follows(
      Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized()).toRotationMatrix() * at_first, 150);
  expect_follows(at_first.colwise() + Vector3d(1e6, 0.7e6, -3e5), 2e6);
  expect_follows((at_first.array().colwise() * Eigen::Array3d(1, 1, 0)).matrix(), 150);
  expect_follows(1e-3 * at_first, 0.15);
  expect_follows(at_first, 150);
}

TEST(MoveVertices, RefusesOtherNumbersAndPlacesThatAreNotFiniteAndStaysWhereItWas) {
  const TriangleMesh sphere = test::icosphere(2, 10);
  SurfaceQuery query(sphere);
  EXPECT_THROW(query.move_vertices(sphere.vertices.leftCols(9)), InvalidInput);
  Eigen::Matrix3Xd bad = 2 * sphere.vertices;
  bad(1, 5) = kNaN;
  try {
    query.move_vertices(bad);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("vertex 5"), std::string::npos);
  }
  EXPECT_EQ(query.closest_point(2 * sphere.vertices.col(3)).distance,
            SurfaceQuery(sphere).closest_point(2 * sphere.vertices.col(3)).distance);
}

}  // namespace
}  // namespace palpate::geometry
