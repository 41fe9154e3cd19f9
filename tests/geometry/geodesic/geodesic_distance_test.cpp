// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/geodesic_distance.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "geodesic/geodesic_testing.h"
#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

using test::kMaxError;
using test::kMeanError;
using test::kWayRounding;
using test::straight_distances;

GeodesicDistance from_one(const TriangleMesh& mesh, const SurfacePoint& source) {
  return geodesic_distance(mesh, std::vector<SurfacePoint>{source});
}

TEST(GeodesicDistances, AreThoseOfEachSourceAloneForAnyNumberOfThreads) {
  const TriangleMesh mesh = test::icosphere(3, 40);
  std::vector<SurfacePoint> sources;
  for (int t = 0; t < 1200; t += 100) sources.push_back({t, Vector3d(0.2, 0.3, 0.5)});
  for (const GeodesicMethod method : {GeodesicMethod::fast_marching, GeodesicMethod::exact}) {
    std::vector<int> told;
    const Eigen::MatrixXd found = geodesic_distances(
        mesh, sources, {.method = method, .stop_radius = 70, .progress = [&](int done, int total) {
                          EXPECT_EQ(total, 12);
                          told.push_back(done);
                        }});
    ASSERT_EQ(found.cols(), 12);
    for (size_t i = 0; i < sources.size(); ++i) {
      const GeodesicDistance alone = geodesic_distance(mesh, std::span(sources).subspan(i, 1),
                                                       {.method = method, .stop_radius = 70});
      EXPECT_TRUE(found.col(static_cast<Eigen::Index>(i)) == alone.distance) << i;
    }
    EXPECT_EQ(told, (std::vector<int>{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12}));
    const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_TRUE(geodesic_distances(mesh, sources, {.method = method, .stop_radius = 70}) == found);
  }
}

TEST(GeodesicDistance, OnAFlatSheetIsTheStraightOneFromFacesEdgesAndVertices) {
  const TriangleMesh sheet = test::flat_sheet(37, 23, 1.3);
  for (const Vector3d& barycentric :
       {Vector3d(0.2, 0.3, 0.5), Vector3d(0.4, 0, 0.6), Vector3d(0, 1, 0)}) {
    const SurfacePoint source{.triangle = 777, .barycentric = barycentric};
    const GeodesicDistance geodesic = from_one(sheet, source);
    const Eigen::VectorXd truth = straight_distances(sheet, source);
    EXPECT_LT((geodesic.distance - truth).cwiseAbs().maxCoeff(), kWayRounding * truth.maxCoeff());
    EXPECT_TRUE((geodesic.label.array() == 0).all());
  }
}

TEST(GeodesicDistance, IsExactOnLongObtuseTriangles) {
  TriangleMesh sheet = test::flat_sheet(40, 30, 1.3);
  sheet.vertices.row(0) = 20 * sheet.vertices.row(0) + 13 * sheet.vertices.row(1);
  const SurfacePoint source{.triangle = 1001, .barycentric = {0.2, 0.3, 0.5}};
  const Eigen::VectorXd truth = straight_distances(sheet, source);
  EXPECT_LT((from_one(sheet, source).distance - truth).cwiseAbs().maxCoeff(),
            kWayRounding * truth.maxCoeff());
}

TEST(GeodesicDistance, OnACylinderIsThatOfTheUnrolledSheet) {
  constexpr double kRadius = 20;
  constexpr int kColumns = 32;  // half way round
  constexpr double kSpacing = std::numbers::pi * kRadius / kColumns;
  const TriangleMesh flat = test::flat_sheet(kColumns, 60, kSpacing);
  TriangleMesh rolled = flat;
  for (Eigen::Index v = 0; v < flat.vertices.cols(); ++v) {
    const double angle = flat.vertices(0, v) / kRadius;
    rolled.vertices.col(v) << kRadius * std::cos(angle), kRadius * std::sin(angle),
        flat.vertices(1, v);
  }
  const SurfacePoint source{.triangle = 1234, .barycentric = {0.2, 0.3, 0.5}};
  const test::RelativeErrors errors = test::relative_errors(
      from_one(rolled, source).distance, straight_distances(flat, source), 2 * kSpacing);
  EXPECT_LT(errors.mean, 0.2 * kMeanError);
  EXPECT_LT(errors.max, 0.2 * kMaxError);
}

TEST(GeodesicDistance, OnASphereIsThatOfGreatCircles) {
  constexpr double kRadius = 50;
  double last_mean = 0.01;
  for (const int levels : {3, 4, 5}) {
    const TriangleMesh sphere = test::icosphere(levels, kRadius);
    const SurfacePoint source{.triangle = 7, .barycentric = {0.2, 0.3, 0.5}};
    const Vector3d pole = position(sphere, source).normalized();
    Eigen::VectorXd truth(sphere.vertices.cols());
    for (Eigen::Index v = 0; v < truth.size(); ++v) {
      const Vector3d p = sphere.vertices.col(v).normalized();
      truth[v] = kRadius * std::atan2(pole.cross(p).norm(), pole.dot(p));
    }
    const test::RelativeErrors errors =
        test::relative_errors(from_one(sphere, source).distance, truth, 4);
    EXPECT_LT(errors.mean, 0.6 * last_mean);
    last_mean = errors.mean;
    if (levels < 5) continue;
    EXPECT_LT(errors.mean, kMeanError);
    EXPECT_LT(errors.max, kMaxError);
  }
}

TEST(GeodesicDistance, OnAConeIsThatOfItsUnrolledSector) {
  // A sector of 3 rad closed to a cone: its apex is sharp, and ways go round it on either side.
  constexpr int kAround = 90;
  constexpr int kRings = 40;
  constexpr double kSector = 3;
  constexpr double kSlant = 50;
  const double slope = kSector / (2 * std::numbers::pi);  // radius over slant height
  TriangleMesh cone;
  cone.vertices.resize(3, kAround * kRings + 1);
  cone.vertices.col(kAround * kRings).setZero();
  Eigen::Matrix2Xd polar(2, cone.vertices.cols());  // slant height, angle on the sector
  polar.col(kAround * kRings).setZero();
  std::vector<Eigen::Vector3i> triangles;
  for (int ring = 0; ring < kRings; ++ring) {
    for (int i = 0; i < kAround; ++i) {
      const int v = ring * kAround + i;
      const int right = ring * kAround + (i + 1) % kAround;
      polar.col(v) << kSlant * (ring + 1) / kRings, kSector * i / kAround;
      const double angle = 2 * std::numbers::pi * i / kAround;
      cone.vertices.col(v) =
          polar(0, v) *
          Vector3d(slope * std::cos(angle), slope * std::sin(angle), std::sqrt(1 - slope * slope));
      if (ring == 0) {
        triangles.emplace_back(kAround * kRings, v, right);
      } else {
        triangles.emplace_back(v - kAround, v, right);
        triangles.emplace_back(v - kAround, right, right - kAround);
      }
    }
  }
  cone.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (size_t t = 0; t < triangles.size(); ++t) {
    cone.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  const int source = 25 * kAround;  // at angle 0
  int triangle = 0;
  while ((cone.triangles.col(triangle).array() != source).all()) ++triangle;
  const Vector3d corner = (cone.triangles.col(triangle).array() == source).cast<double>();
  Eigen::VectorXd truth(cone.vertices.cols());
  for (Eigen::Index v = 0; v < truth.size(); ++v) {
    const double turn = std::min(polar(1, v), kSector - polar(1, v));
    const double r = polar(0, source);
    truth[v] = std::sqrt(r * r + polar(0, v) * polar(0, v) - 2 * r * polar(0, v) * std::cos(turn));
  }
  const test::RelativeErrors errors = test::relative_errors(
      from_one(cone, {.triangle = triangle, .barycentric = corner}).distance, truth, 4);
  EXPECT_LT(errors.mean, kMeanError);
  EXPECT_LT(errors.max, kMaxError);
}

TEST(GeodesicDistance, IsNearlyTheSameBackwards) {
  const TriangleMesh mesh = test::bumpy(8000, 0.25);
  std::vector<GeodesicDistance> from;
  std::vector<int> vertices;
  for (const int t : {37, 1500, 3333, 5001, 7600}) {
    from.push_back(from_one(mesh, corner_point(t, 2)));
    vertices.push_back(mesh.triangles(2, t));
  }
  for (size_t i = 0; i < from.size(); ++i) {
    for (size_t j = 0; j < i; ++j) {
      const double there = from[i].distance[vertices[j]];
      EXPECT_NEAR(there, from[j].distance[vertices[i]], 2 * kMaxError * there);
    }
  }
}

TEST(GeodesicDistance, MovesAlongWithTheMesh) {
  const TriangleMesh mesh = test::bumpy(3000, 0.25);
  const std::vector<SurfacePoint> sources = {{7, {0.2, 0.3, 0.5}}, {901, {0.2, 0.3, 0.5}}};
  Eigen::Isometry3d motion(Eigen::AngleAxisd(1.1, Vector3d(0.3, 0.5, -0.7).normalized()));
  motion.pretranslate(Vector3d(100.1, -20.7, 3.3));
  const GeodesicDistance expected = geodesic_distance(mesh, sources);
  const GeodesicDistance moved = geodesic_distance(test::moved(mesh, motion), sources);
  // Rounding may decide which of two triangles a wave goes through, which differs by little.
  EXPECT_LT(test::relative_errors(moved.distance, expected.distance, 0).max, 1e-6);
  EXPECT_EQ(moved.label, expected.label);
}

TEST(GeodesicDistance, LabelsOfManySourcesOnAFlatSheetAreTheNearestSources) {
  const TriangleMesh sheet = test::flat_sheet(60, 50, 1.1);
  std::mt19937 random(5);
  std::uniform_int_distribution<int> any(0, static_cast<int>(sheet.triangles.cols()) - 1);
  std::vector<SurfacePoint> sources;
  for (int i = 0; i < 40; ++i) {
    sources.push_back({.triangle = any(random), .barycentric = {0.2, 0.3, 0.5}});
  }
  const GeodesicDistance geodesic = geodesic_distance(sheet, sources);
  for (Eigen::Index v = 0; v < sheet.vertices.cols(); ++v) {
    double nearest = kInf;
    for (const SurfacePoint& source : sources) {
      nearest = std::min(nearest, (position(sheet, source) - sheet.vertices.col(v)).norm());
    }
    const SurfacePoint& labelled = sources[static_cast<size_t>(geodesic.label[v])];
    EXPECT_NEAR(geodesic.distance[v], nearest, kWayRounding * 100);
    EXPECT_NEAR((position(sheet, labelled) - sheet.vertices.col(v)).norm(), nearest,
                1e-8 * nearest);
  }
}

TEST(GeodesicDistance, OfManySourcesIsTheLeastOfTheDistancesOfEach) {
  const TriangleMesh bumpy = test::height_field(60, 50, 1.0, [](double x, double y) {
    return 5 * std::sin(x / 7) * std::cos(y / 9) + std::sin(x / 2.3 + y / 3.1);
  });
  std::vector<SurfacePoint> sources;
  for (const int t : {37, 1234, 2222, 3131, 4545, 5678}) {
    sources.push_back({.triangle = t, .barycentric = {0.3, 0.3, 0.4}});
  }
  const GeodesicDistance together = geodesic_distance(bumpy, sources);
  Eigen::VectorXd least = Eigen::VectorXd::Constant(bumpy.vertices.cols(), kInf);
  for (const SurfacePoint& source : sources) {
    least = least.cwiseMin(from_one(bumpy, source).distance);
  }
  EXPECT_LT(((together.distance - least).array() / (1 + least.array())).abs().maxCoeff(), 1e-6);
}

TEST(GeodesicDistance, SymmetricSourcesGetSymmetricLabels) {
  // An even number of columns makes the alternating diagonals symmetric about the middle one.
  constexpr int kCols = 40;
  const TriangleMesh mesh = test::height_field(kCols, 30, 1.0, [](double x, double y) {
    return 3 * std::cos((x - kCols / 2.0) / 5) * std::cos(y / 6);
  });
  const std::vector<SurfacePoint> vertices = vertex_points(mesh);
  const size_t row = 15 * (kCols + 1);
  const SurfacePoint left = vertices[row + 8];
  const SurfacePoint right = vertices[row + kCols - 8];
  for (const std::vector<SurfacePoint>& sources : {std::vector{left, right}, {right, left}}) {
    const GeodesicDistance geodesic = geodesic_distance(mesh, sources);
    for (int v = 0; v < mesh.vertices.cols(); ++v) {
      const int c = v % (kCols + 1);
      const int mirrored = v - c + (kCols - c);
      EXPECT_NEAR(geodesic.distance[v], geodesic.distance[mirrored], kWayRounding * 50);
      // On the axis it is a tie, which goes to the first source.
      const int expected = c == kCols / 2 ? 0 : 1 - geodesic.label[mirrored];
      EXPECT_EQ(geodesic.label[v], expected) << v;
    }
  }
}

TEST(GeodesicDistance, TiesGoToTheLowestSource) {
  const TriangleMesh sheet = test::flat_sheet(10, 10, 0.7);
  const SurfacePoint source{.triangle = 55, .barycentric = {0.2, 0.3, 0.5}};
  const GeodesicDistance geodesic =
      geodesic_distance(sheet, std::vector<SurfacePoint>{source, source});
  EXPECT_TRUE((geodesic.label.array() == 0).all());
}

TEST(GeodesicDistance, DoesNotReachADisconnectedPart) {
  TriangleMesh two = test::flat_sheet(4, 4, 1);
  const Eigen::Index vertices = two.vertices.cols();
  const Eigen::Index triangles = two.triangles.cols();
  two.vertices.conservativeResize(3, 2 * vertices + 1);
  two.vertices.middleCols(vertices, vertices) =
      two.vertices.leftCols(vertices).colwise() + Vector3d(0, 0, 0.01);
  two.vertices.col(2 * vertices).setZero();  // in no triangle
  two.triangles.conservativeResize(3, 2 * triangles);
  two.triangles.rightCols(triangles) =
      two.triangles.leftCols(triangles).array() + static_cast<int>(vertices);
  const GeodesicDistance geodesic = from_one(two, corner_point(3, 0));
  EXPECT_TRUE(geodesic.distance.head(vertices).allFinite());
  EXPECT_TRUE((geodesic.distance.tail(vertices + 1).array() == kInf).all());
  EXPECT_TRUE((geodesic.label.tail(vertices + 1).array() == -1).all());
}

TEST(GeodesicDistance, StopsAtTheRadius) {
  TriangleMesh sheet = test::flat_sheet(30, 30, 1.3);
  sheet.vertices.row(0) += 2.6 * sheet.vertices.row(1);
  const SurfacePoint source{.triangle = 901, .barycentric = {0.2, 0.3, 0.5}};
  const Eigen::VectorXd truth = straight_distances(sheet, source);
  const GeodesicDistance geodesic =
      geodesic_distance(sheet, std::vector<SurfacePoint>{source}, {.stop_radius = 9.1});
  for (Eigen::Index v = 0; v < truth.size(); ++v) {
    if (truth[v] <= 9.1) {
      EXPECT_NEAR(geodesic.distance[v], truth[v], kWayRounding * 10);
    } else {
      EXPECT_EQ(geodesic.distance[v], kInf);
      EXPECT_EQ(geodesic.label[v], -1);
    }
  }
}

TEST(GeodesicDistance, OfManySourcesWithinARadiusIsThatWithoutOne) {
  const TriangleMesh mesh = test::bumpy(3000, 0.25);
  std::vector<SurfacePoint> sources;
  for (int t = 50; t < mesh.triangles.cols(); t += 200) {
    sources.push_back({.triangle = t, .barycentric = {0.2, 0.3, 0.5}});
  }
  const GeodesicDistance whole = geodesic_distance(mesh, sources);
  const double radius = 0.5 * whole.distance.maxCoeff();
  const GeodesicDistance part = geodesic_distance(mesh, sources, {.stop_radius = radius});
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    const bool is_within = whole.distance[v] <= radius;
    EXPECT_EQ(part.distance[v], is_within ? whole.distance[v] : kInf) << v;
    EXPECT_EQ(part.label[v], is_within ? whole.label[v] : -1) << v;
  }
}

TEST(GeodesicDistance, ReachesVerticesInOnePlaceFromManySources) {
  TriangleMesh sheet = test::flat_sheet(6, 4, 1);
  for (const int v : {9, 10, 11, 16, 17, 18, 19}) sheet.vertices.col(v) = Vector3d(2, 1, 0);
  const std::vector<SurfacePoint> sources = {{0, {0.2, 0.3, 0.5}}, {40, {0.2, 0.3, 0.5}}};
  EXPECT_TRUE(geodesic_distance(sheet, sources).distance.allFinite());
}

TEST(GeodesicDistance, ScalesExactlyWithTheUnitOfLength) {
  const TriangleMesh sphere = test::icosphere(3, 10.7);
  const std::vector<SurfacePoint> sources = {{7, {0.2, 0.3, 0.5}}, {901, {0.2, 0.3, 0.5}}};
  const GeodesicDistance expected = geodesic_distance(sphere, sources);
  for (const double factor : {0x1p-20, 0x1p20}) {
    const GeodesicDistance scaled = geodesic_distance(test::scaled(sphere, factor), sources);
    EXPECT_EQ(scaled.distance, factor * expected.distance);
    EXPECT_EQ(scaled.label, expected.label);
  }
}

TEST(GeodesicDistance, PassesTrianglesWithoutArea) {
  TriangleMesh strip = test::flat_sheet(6, 2, 1);
  // The third column of vertices falls upon the second.
  for (int r = 0; r < 3; ++r) strip.vertices(0, 7 * r + 2) = 1;
  const GeodesicDistance geodesic = from_one(strip, corner_point(0, 0));
  for (Eigen::Index v = 0; v < strip.vertices.cols(); ++v) {
    const double truth = strip.vertices.col(v).norm();
    EXPECT_GE(geodesic.distance[v], truth * (1 - kWayRounding));
    EXPECT_LE(geodesic.distance[v], 1.1 * truth);
  }
}

TEST(GeodesicDistance, RefusesBadInputAndNamesIt) {
  const auto refused = [](const TriangleMesh& mesh, const std::vector<SurfacePoint>& sources,
                          const GeodesicOptions& options = {}) {
    const std::string message = refusal([&] { return geodesic_distance(mesh, sources, options); });
    EXPECT_EQ(refusal([&] { return geodesic_distances(mesh, sources, options); }), message);
    return message;
  };
  const TriangleMesh sheet = test::flat_sheet(2, 2, 1);
  const SurfacePoint good = corner_point(0, 0);
  EXPECT_NE(refused({}, {good}).find("no triangles"), std::string::npos);
  EXPECT_NE(refused(sheet, {}).find("no source"), std::string::npos);
  EXPECT_NE(refused(sheet, {good, corner_point(8, 0)}).find("source 1"), std::string::npos);
  EXPECT_NE(refused(sheet, {{.triangle = 0, .barycentric = {1, 1, 0}}}).find("source 0"),
            std::string::npos);
  TriangleMesh broken = sheet;
  broken.vertices(1, 3) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(refused(broken, {good}).find("vertex 3 is not finite"), std::string::npos);
  EXPECT_NE(
      refused(sheet, {{0, {1, std::numeric_limits<double>::quiet_NaN(), 0}}}).find("source 0"),
      std::string::npos);
  for (const double radius : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_NE(refused(sheet, {good}, {.stop_radius = radius}).find("stop_radius"),
              std::string::npos);
  }
}

}  // namespace
}  // namespace palpate::geometry
