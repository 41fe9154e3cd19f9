// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/surface_query.h"

#include <gtest/gtest.h>

#include <limits>
#include <thread>
#include <vector>

#include "not_finite.h"
#include "palpate/core/error.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

/// Relative to the size of the mesh: some tens of double operations, and the amplification by the
/// needles among random triangles.
constexpr double kQueryRounding = 1e-12;

std::vector<Vector3d> random_places(int count, double size, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-size, size);
  std::vector<Vector3d> points;
  for (int i = 0; i < count; ++i) {
    points.push_back({uniform(random), uniform(random), uniform(random)});
  }
  return points;
}

/// Distance of a point to a triangle by another way than the library's: the seven regions of
/// Ericson 2005, section 5.1.5.
double ericson_distance(const Vector3d& p, const Vector3d& a, const Vector3d& b,
                        const Vector3d& c) {
  const Vector3d ab = b - a;
  const Vector3d ac = c - a;
  const double d1 = ab.dot(p - a), d2 = ac.dot(p - a);
  if (d1 <= 0 && d2 <= 0) return (p - a).norm();
  const double d3 = ab.dot(p - b), d4 = ac.dot(p - b);
  if (d3 >= 0 && d4 <= d3) return (p - b).norm();
  const double d5 = ab.dot(p - c), d6 = ac.dot(p - c);
  if (d6 >= 0 && d5 <= d6) return (p - c).norm();
  const double vc = d1 * d4 - d3 * d2, vb = d5 * d2 - d1 * d6, va = d3 * d6 - d5 * d4;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return (p - a - d1 / (d1 - d3) * ab).norm();
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return (p - a - d2 / (d2 - d6) * ac).norm();
  if (va <= 0 && d4 >= d3 && d5 >= d6) {
    return (p - b - (d4 - d3) / ((d4 - d3) + (d5 - d6)) * (c - b)).norm();
  }
  return std::abs(ab.cross(ac).normalized().dot(p - a));
}

double ericson_distance(const TriangleMesh& mesh, const Vector3d& p) {
  double nearest = kInf;
  for (const auto& t : mesh.triangles.colwise()) {
    nearest = std::min(nearest, ericson_distance(p, mesh.vertices.col(t[0]),
                                                 mesh.vertices.col(t[1]), mesh.vertices.col(t[2])));
  }
  return nearest;
}

/// First crossing by Moeller and Trumbore 1997 on every triangle; infinity if there is none.
double brute_force_fraction(const TriangleMesh& mesh, const Vector3d& start, const Vector3d& end) {
  double first = kInf;
  const Vector3d along = end - start;
  for (const auto& t : mesh.triangles.colwise()) {
    const Vector3d a = mesh.vertices.col(t[0]);
    const Vector3d ab = mesh.vertices.col(t[1]) - a;
    const Vector3d ac = mesh.vertices.col(t[2]) - a;
    const double det = ab.dot(along.cross(ac));
    const double v = (start - a).dot(along.cross(ac)) / det;
    const double w = along.dot((start - a).cross(ab)) / det;
    const double fraction = ac.dot((start - a).cross(ab)) / det;
    if (v >= 0 && w >= 0 && v + w <= 1 && fraction >= 0 && fraction <= 1) {
      first = std::min(first, fraction);
    }
  }
  return first;
}

/// The answer must name one and the same place in all its members.
void expect_consistent(const TriangleMesh& mesh, const Vector3d& p, const ClosestPoint& closest) {
  EXPECT_GE(closest.at.barycentric.minCoeff(), 0);
  EXPECT_NEAR(closest.at.barycentric.sum(), 1, kQueryRounding);
  EXPECT_EQ(closest.position, position(mesh, closest.at));
  EXPECT_NEAR((p - closest.position).norm(), closest.distance,
              kQueryRounding * (bounding_diagonal(mesh) + p.norm()));
}

TEST(ClosestPoint, EqualsASearchThroughAllTriangles) {
  const TriangleMesh mesh = test::random_triangles(700, 30, 1);
  const SurfaceQuery query(mesh);
  for (const double size : {10.0, 40.0, 3000.0}) {
    for (const Vector3d& p : random_places(500, size, 2)) {
      const ClosestPoint closest = query.closest_point(p);
      EXPECT_NEAR(closest.distance, ericson_distance(mesh, p), kQueryRounding * size);
      expect_consistent(mesh, p, closest);
    }
  }
}

TEST(ClosestPoint, IsFoundAmongTrianglesThatSinglePrecisionCannotTellApart) {
  // Parallel sheets 1e-9 of their size apart, the nearest in the middle of the list.
  constexpr int kSheets = 41;
  constexpr double kGap = 1e-7;
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3 * kSheets);
  mesh.triangles.resize(3, kSheets);
  for (int i = 0; i < kSheets; ++i) {
    const double z = kGap * ((i * 23) % kSheets);
    mesh.vertices.middleCols(3 * i, 3) << 0, 100, 0, 0, 0, 100, z, z, z;
    mesh.triangles.col(i) << 3 * i, 3 * i + 1, 3 * i + 2;
  }
  const SurfaceQuery query(mesh);
  for (const Vector3d& random : random_places(200, 1, 12)) {
    for (const double depth : {50.3, 5000.7}) {
      const Vector3d p = Vector3d(20, 20, -2 * depth) + depth * random;
      EXPECT_EQ(mesh.vertices(2, 3 * query.closest_point(p).at.triangle), 0);
      const auto hit = query.first_hit(p, Vector3d(20, 20, 0) - 0.1 * (p - Vector3d(20, 20, 0)));
      ASSERT_TRUE(hit.has_value());
      EXPECT_EQ(mesh.vertices(2, 3 * hit->at.triangle), 0);
    }
  }
}

TEST(ClosestPoint, OfASphereIsOnTheRadius) {
  constexpr double kRadius = 50;
  const TriangleMesh sphere = test::icosphere(5, kRadius);
  const SurfaceQuery query(sphere);
  // Depth of a chord plane below the sphere: edge^2 / (6 R) for an equilateral triangle.
  const double sagitta = std::pow(1.2 * kRadius / 32, 2) / (6 * kRadius) * 1.5;
  for (const Vector3d& p : random_places(300, 80, 3)) {
    const ClosestPoint closest = query.closest_point(p);
    EXPECT_NEAR(closest.distance, std::abs(p.norm() - kRadius), sagitta);
    EXPECT_LT(closest.position.normalized().cross(p.normalized()).norm(), 0.05);
  }
}

TEST(ClosestPoint, OfAPlaneIsTheFootOfThePerpendicular) {
  const Eigen::Isometry3d T = Eigen::Translation3d(3.3, -7.7, 101.1) *
                              Eigen::AngleAxisd(0.7, Vector3d(1, 2, 3).normalized());
  const TriangleMesh plane = test::moved(test::flat_sheet(9, 7, 1.1), T);
  const SurfaceQuery query(plane);
  for (Vector3d p : random_places(300, 3, 4)) {
    p += Vector3d(4.9, 3.8, 0);
    const ClosestPoint closest = query.closest_point(T * p);
    EXPECT_NEAR(closest.distance, std::abs(p.z()), 200 * kQueryRounding);
    EXPECT_LT((closest.position - T * Vector3d(p.x(), p.y(), 0)).norm(), 200 * kQueryRounding);
  }
}

TEST(ClosestPoint, AnswersAsWellOneKilometreAway) {
  constexpr double kKilometre = 1e6;
  const Eigen::Isometry3d T(Eigen::Translation3d(kKilometre, -0.7 * kKilometre, 0.3 * kKilometre));
  const TriangleMesh near = test::icosphere(4, 37.3);
  const SurfaceQuery query_near(near);
  const SurfaceQuery query_far(test::moved(near, T));
  // Two roundings of coordinates of the size of a kilometre.
  constexpr double kRoundingFar = 4e-16 * kKilometre;
  for (const Vector3d& p : random_places(300, 60, 5)) {
    const ClosestPoint a = query_near.closest_point(p);
    const ClosestPoint b = query_far.closest_point(T * p);
    EXPECT_NEAR(a.distance, b.distance, kRoundingFar);
    EXPECT_NEAR(query_far.first_hit(T * p, T * Vector3d::Zero()).value_or(SegmentHit{}).fraction,
                query_near.first_hit(p, Vector3d::Zero()).value_or(SegmentHit{}).fraction,
                10 * kRoundingFar / p.norm());
  }
}

TEST(SurfaceQuery, ScalesExactlyWithTheUnitOfLength) {
  const TriangleMesh mesh = test::random_triangles(200, 30, 6);
  const SurfaceQuery query(mesh);
  for (const double factor : {0x1p-300, 0x1p-20, 0x1p20, 0x1p300}) {
    const SurfaceQuery scaled(test::scaled(mesh, factor));
    const std::vector<Vector3d> points = random_places(200, 40, 7);
    for (size_t i = 1; i < points.size(); ++i) {
      const ClosestPoint a = query.closest_point(points[i]);
      const ClosestPoint b = scaled.closest_point(factor * points[i]);
      EXPECT_EQ(a.at.triangle, b.at.triangle);
      EXPECT_EQ(a.at.barycentric, b.at.barycentric);
      EXPECT_EQ(factor * a.distance, b.distance);
      EXPECT_EQ(factor * a.position, b.position);
      const auto hit = query.first_hit(points[i - 1], points[i]);
      const auto scaled_hit = scaled.first_hit(factor * points[i - 1], factor * points[i]);
      ASSERT_EQ(hit.has_value(), scaled_hit.has_value());
      if (!hit) continue;
      EXPECT_EQ(hit->fraction, scaled_hit->fraction);
    }
  }
}

TEST(ClosestPoint, OfTheCommonVertexIsTheTriangleWithTheLowestIndex) {
  const TriangleMesh sphere = test::icosphere(3, 10);
  const SurfaceQuery query(sphere);
  for (int v = 0; v < sphere.vertices.cols(); ++v) {
    int first = 0;
    while ((sphere.triangles.col(first).array() != v).all()) ++first;
    const ClosestPoint closest = query.closest_point(sphere.vertices.col(v));
    EXPECT_EQ(closest.at.triangle, first);
    EXPECT_EQ(closest.distance, 0);
  }
}

TEST(ClosestPoint, ReachesFarAwayPoints) {
  const SurfaceQuery query(test::icosphere(2, 10));
  for (const double far : {1e5, 1e8, 1e15, 1e100}) {
    EXPECT_NEAR(query.closest_point({far, 0, 0}).distance, far, 10 + 1e-15 * far);
  }
}

TEST(ClosestPoint, ServesMeshesWithoutAreaAndOfOnePoint) {
  TriangleMesh mesh;
  mesh.triangles = Eigen::Vector3i(0, 1, 2);
  mesh.vertices.resize(3, 3);
  mesh.vertices << 0.1, 0.2, 0.3,  //
      0.7, 1.4, 2.1,               //
      0, 0, 0;
  const SurfaceQuery line(mesh);
  EXPECT_NEAR(line.closest_point({0.2, 1.4, 5}).distance, 5, kQueryRounding);
  EXPECT_NEAR(line.closest_point({0, 0, 0}).distance, std::hypot(0.1, 0.7), kQueryRounding);
  mesh.vertices.setConstant(0.7);
  EXPECT_NEAR(SurfaceQuery(mesh).closest_point({0.7, 3.7, 4.7}).distance, 5, kQueryRounding);
}

TEST(SurfaceQuery, AnswersPointsThatAreNotFiniteWithNothing) {
  const SurfaceQuery query(test::icosphere(1, 10));
  for (const double bad : {kNaN, kInf, -kInf}) {
    const Vector3d p(1, bad, 2);
    EXPECT_EQ(query.closest_point(p).at.triangle, -1);
    EXPECT_TRUE(std::isnan(query.closest_point(p).distance));
    EXPECT_TRUE(query.closest_point(p).position.array().isNaN().all());
    EXPECT_FALSE(query.first_hit(p, {0, 0, 0}).has_value());
    EXPECT_FALSE(query.first_hit({0, 0, 0}, p).has_value());
  }
}

TEST(SurfaceQuery, RefusesABadMesh) {
  EXPECT_THROW(SurfaceQuery(TriangleMesh{}), InvalidInput);
  TriangleMesh mesh = test::icosphere(0, 1);
  mesh.vertices(0, 5) = kNaN;
  EXPECT_THROW(SurfaceQuery{mesh}, InvalidInput);
}

TEST(FirstHit, EqualsASearchThroughAllTriangles) {
  const TriangleMesh mesh = test::random_triangles(300, 30, 8);
  const SurfaceQuery query(mesh);
  int hits = 0;
  for (const double size : {5.0, 50.0, 5000.0}) {
    const std::vector<Vector3d> starts = random_places(400, size, 9);
    const std::vector<Vector3d> targets = random_places(400, 30, 10);
    for (size_t i = 0; i < starts.size(); ++i) {
      // As far beyond the target as before it.
      const Vector3d end = 2 * targets[i] - starts[i];
      const double expected = brute_force_fraction(mesh, starts[i], end);
      const auto hit = query.first_hit(starts[i], end);
      ASSERT_EQ(hit.has_value(), expected < kInf);
      if (!hit) continue;
      ++hits;
      EXPECT_NEAR(hit->fraction, expected, 10 * kQueryRounding);
      EXPECT_EQ(hit->position, position(mesh, hit->at));
      EXPECT_LT((hit->position - starts[i] - hit->fraction * (end - starts[i])).norm(),
                kQueryRounding * (30 + size));
    }
  }
  EXPECT_GT(hits, 300);
}

TEST(FirstHit, IsFoundFromBothSides) {
  const SurfaceQuery query(test::icosphere(3, 10));
  const auto from_outside = query.first_hit({0.3, 0.2, 30}, {0.3, 0.2, 0});
  const auto from_inside = query.first_hit({0.3, 0.2, 0}, {0.3, 0.2, 30});
  ASSERT_TRUE(from_outside && from_inside);
  EXPECT_EQ(from_outside->at.triangle, from_inside->at.triangle);
  EXPECT_NEAR(from_outside->fraction, 1 - from_inside->fraction, kQueryRounding);
}

TEST(FirstHit, NeverSlipsThroughVerticesAndEdges) {
  const TriangleMesh sphere = test::moved(
      test::icosphere(3, 10.7), Eigen::Isometry3d(Eigen::Translation3d(1000.1, 0.7, -33.3)));
  const SurfaceQuery query(sphere);
  const Vector3d centre(1000.1, 0.7, -33.3);
  for (const auto& t : sphere.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const Vector3d a = sphere.vertices.col(t[k]);
      const Vector3d b = sphere.vertices.col(t[(k + 1) % 3]);
      for (const double along : {0.0, 0.3, 0.5}) {
        const Vector3d target = a + along * (b - a);
        EXPECT_TRUE(query.first_hit(centre, centre + 2 * (target - centre)).has_value());
      }
    }
  }
}

TEST(FirstHit, CountsASegmentThatStartsOrEndsOnTheSurface) {
  const TriangleMesh sphere = test::icosphere(3, 10.7);
  const SurfaceQuery query(sphere);
  for (int t = 0; t < sphere.triangles.cols(); ++t) {
    const Vector3d on = position(sphere, {t, {0.21, 0.33, 0.46}});
    const Vector3d outside = 1.7 * on;
    const auto leaving = query.first_hit(on, outside);
    ASSERT_TRUE(leaving.has_value());
    EXPECT_EQ(leaving->fraction, 0);
    EXPECT_EQ(leaving->at.triangle, t);
    const auto arriving = query.first_hit(outside, on);
    ASSERT_TRUE(arriving.has_value());
    EXPECT_NEAR(arriving->fraction, 1, kQueryRounding);
    EXPECT_FALSE(query.first_hit(1.0001 * on, outside).has_value());
  }
}

TEST(FirstHit, OfASegmentWithoutLengthIsThereIffItIsOnTheSurface) {
  const TriangleMesh sphere = test::icosphere(2, 10.7);
  const SurfaceQuery query(sphere);
  const Vector3d on = position(sphere, {17, {0.2, 0.3, 0.5}});
  const auto hit = query.first_hit(on, on);
  ASSERT_TRUE(hit.has_value());
  EXPECT_EQ(hit->at.triangle, 17);
  EXPECT_EQ(hit->fraction, 0);
  EXPECT_FALSE(query.first_hit(1.001 * on, 1.001 * on).has_value());
}

TEST(FirstHit, ServesSegmentsOfAnyLength) {
  const SurfaceQuery query(test::flat_sheet(4, 4, 2.5));
  for (const double length : {1e-9, 1e-3, 1e3, 1e9, 1e12}) {
    const auto hit = query.first_hit({3.3, 4.4, 0.25 * length}, {3.3, 4.4, -0.75 * length});
    ASSERT_TRUE(hit.has_value()) << length;
    EXPECT_NEAR(hit->fraction, 0.25, kQueryRounding);
    EXPECT_FALSE(query.first_hit({3.3, 14.4, length}, {3.3, 14.4, -length}).has_value());
  }
}

TEST(FirstHit, IsNoneInThePlaneOfASheetUnlessAnEndIsOnIt) {
  const SurfaceQuery query(test::flat_sheet(4, 4, 2.5));
  EXPECT_FALSE(query.first_hit({-1, 3, 0}, {20, 4, 0}).has_value());
  EXPECT_TRUE(query.first_hit({-1, 3, 0}, {2, 4, 0}).has_value());
}

TEST(SurfaceQuery, GivesTheSameAnswersFromManyThreads) {
  const TriangleMesh sphere = test::icosphere(4, 10);
  SurfaceQuery original(sphere);
  const SurfaceQuery query = std::move(original);
  const std::vector<Vector3d> points = random_places(2000, 15, 11);
  std::vector<std::vector<double>> distances(4);
  {
    std::vector<std::jthread> threads;
    for (std::vector<double>& mine : distances) {
      threads.emplace_back([&query, &points, &mine] {
        for (const Vector3d& p : points) mine.push_back(query.closest_point(p).distance);
      });
    }
  }
  for (const std::vector<double>& mine : distances) EXPECT_EQ(mine, distances.front());
}

}  // namespace
}  // namespace palpate::geometry
