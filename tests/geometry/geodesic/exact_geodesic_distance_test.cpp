// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geodesic/geodesic_testing.h"
#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/geometry/geodesic_distance.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;
using test::straight_distances;

/// Accuracy that the header guarantees; relative to the distance and the mean length of the edges.
constexpr double kAccuracy = 1e-10;

GeodesicDistance exact(const TriangleMesh& mesh, const std::vector<SurfacePoint>& sources,
                       double stop_radius = kInf) {
  return geodesic_distance(mesh, sources,
                           {.method = GeodesicMethod::exact, .stop_radius = stop_radius});
}

/// Largest error relative to the true distance and the mean edge.
double largest_error(const TriangleMesh& mesh, const Eigen::VectorXd& measured,
                     const Eigen::VectorXd& truth) {
  double edges = 0;
  for (const auto& corners : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      edges += (mesh.vertices.col(corners[k]) - mesh.vertices.col(corners[(k + 1) % 3])).norm();
    }
  }
  const double mean_edge = edges / static_cast<double>(mesh.triangles.size());
  return ((measured - truth).array().abs() / (truth.array() + mean_edge)).maxCoeff();
}

TEST(ExactGeodesicDistance, OnAFlatSheetIsTheStraightOneFromFacesEdgesAndVertices) {
  // Straight ways run through many vertices here: the ties must not upset it.
  for (const double shear : {0.0, 2.0, 13.0}) {  // 13: long obtuse triangles
    TriangleMesh sheet = test::flat_sheet(29, 19, 1.3);
    sheet.vertices.row(0) += shear * sheet.vertices.row(1);
    for (const Vector3d& barycentric :
         {Vector3d(0.2, 0.3, 0.5), Vector3d(0.4, 0, 0.6), Vector3d(0.3, 0.7, 0),
          Vector3d(0, 0.1, 0.9), Vector3d(1e-9, 0.4, 0.6 - 1e-9), Vector3d(0, 1, 0)}) {
      for (const int triangle : {0, 555}) {  // at the border and inside
        const SurfacePoint source{.triangle = triangle, .barycentric = barycentric};
        EXPECT_LT(largest_error(sheet, exact(sheet, {source}).distance,
                                straight_distances(sheet, source)),
                  kAccuracy);
      }
    }
  }
}

TEST(ExactGeodesicDistance, OfASourceNextToAVertexOrAnEdgeIsTheStraightOne) {
  // Nearer to a vertex than coordinates can tell, it would see nothing behind the vertex.
  const TriangleMesh sheet = test::flat_sheet(9, 7, 1.3);
  for (const double apart : {1e-300, 1e-17, 1e-14, 1e-9, 1e-7, 1e-5}) {
    for (const Vector3d& barycentric :
         {Vector3d(apart, apart, 1 - 2 * apart), Vector3d(1 - 2 * apart, apart, apart),
          Vector3d(0.4, apart, 0.6 - apart)}) {
      for (const int triangle : {0, 27, 64}) {
        const SurfacePoint source{.triangle = triangle, .barycentric = barycentric};
        EXPECT_LT(largest_error(sheet, exact(sheet, {source}).distance,
                                straight_distances(sheet, source)),
                  kAccuracy);
      }
    }
  }
}

TEST(ExactGeodesicDistance, OnNeedlesInAnyPositionIsTheStraightOne) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0, 1);
  for (int i = 0; i < 10; ++i) {
    TriangleMesh sheet = test::flat_sheet(30, 20, 1);
    sheet.vertices.row(0) *= 1e5;
    const Eigen::Isometry3d turn(
        Eigen::AngleAxisd(6 * any(random), Vector3d{any(random), any(random), 1}.normalized()));
    sheet = test::moved(sheet, turn);
    const SurfacePoint source{.triangle = 100 * i, .barycentric = {0.2, 0.3, 0.5}};
    EXPECT_LT(
        largest_error(sheet, exact(sheet, {source}).distance, straight_distances(sheet, source)),
        kAccuracy);
  }
}

TEST(ExactGeodesicDistance, OnNeedlesAndCapsOfHardlyAnyWidthIsTheStraightOne) {
  std::mt19937 random(4);
  std::uniform_real_distribution<double> any(0, 1);
  for (const double width : {1e-6, 1e-8, 1e-10}) {
    for (const bool caps : {false, true}) {
      TriangleMesh sheet = test::flat_sheet(24, 18, 1);
      for (Eigen::Index v = 0; v < sheet.vertices.cols(); ++v) {
        const Eigen::Index col = v % 25, row = v / 25;
        // Whole lines of vertices onto the next ones, or every third vertex of them.
        if (caps && row % 2 == 1) sheet.vertices(1, v) -= 1 - width;
        if (!caps && col % 3 == 1) sheet.vertices(0, v) -= 1 - width;
      }
      const Eigen::Isometry3d turn(
          Eigen::AngleAxisd(6 * any(random), Vector3d{any(random), any(random), 1}.normalized()));
      for (const TriangleMesh& mesh : {sheet, test::moved(sheet, turn)}) {
        const SurfacePoint source{.triangle = 555, .barycentric = {0.2, 0.3, 0.5}};
        const Eigen::VectorXd truth = straight_distances(mesh, source);
        const GeodesicDistance geodesic = exact(mesh, {source});
        EXPECT_TRUE((geodesic.distance.array() > 0 || truth.array() < 1e-6).all());
        EXPECT_LT(largest_error(mesh, geodesic.distance, truth), kAccuracy) << width << caps;
      }
    }
  }
}

TEST(ExactGeodesicDistance, InTheShadowOfAHoleIsThatRoundItsCorners) {
  constexpr int kCells = 9;
  constexpr double kSpacing = 0.7;
  const TriangleMesh plate = test::plate_with_hole(kCells, kSpacing);
  const Eigen::VectorXd truth = test::distances_around_hole(plate, kCells, kSpacing);
  const GeodesicDistance geodesic = exact(plate, {corner_point(0, 0)});
  for (Eigen::Index v = 0; v < truth.size(); ++v) {
    if (truth[v] == kInf) {
      EXPECT_EQ(geodesic.distance[v], kInf) << v;
    } else {
      EXPECT_NEAR(geodesic.distance[v], truth[v], kAccuracy * (truth[v] + kSpacing)) << v;
    }
  }
}

/// A regular tetrahedron of edge 1, each face cut into `n` x `n` triangles; and the positions of
/// its vertices when it rolls over the plane. All its images there are +-p plus twice the lattice
/// of its corners, so that the length of the shortest way is that of the shortest straight line
/// between images.
struct RolledTetrahedron {
  TriangleMesh mesh;
  Eigen::Matrix2Xd rolled;
};

RolledTetrahedron tetrahedron(int n) {
  const std::array<Vector3d, 4> corners = {Vector3d(1, 1, 1), Vector3d(1, -1, -1),
                                           Vector3d(-1, 1, -1), Vector3d(-1, -1, 1)};
  // Turned outwards; with places of the three corners on the lattice whose cell has a corner of
  // each name. Its basis is (1, 0) and (1/2, sqrt(3)/2).
  struct Face {
    std::array<size_t, 3> corners;
    std::array<Eigen::Vector2d, 3> lattice;
  };
  const std::array<Face, 4> faces = {{{{0, 1, 2}, {{{0, 0}, {1, 0}, {0, 1}}}},
                                      {{3, 2, 1}, {{{1, 1}, {0, 1}, {1, 0}}}},
                                      {{1, 0, 3}, {{{1, 0}, {0, 0}, {1, -1}}}},
                                      {{0, 2, 3}, {{{0, 0}, {0, 1}, {-1, 1}}}}}};
  const Eigen::Matrix2d basis{{1, 0.5}, {0, std::sqrt(0.75)}};
  std::map<std::array<int, 4>, int> vertex_of;
  std::vector<Vector3d> vertices;
  std::vector<Eigen::Vector2d> rolled;
  std::vector<Eigen::Vector3i> triangles;
  for (const Face& face : faces) {
    const auto vertex = [&](int i, int j) {
      const std::array<int, 3> weights = {n - i - j, i, j};
      std::array<int, 4> name{};
      Vector3d at = Vector3d::Zero();
      Eigen::Vector2d lattice = Eigen::Vector2d::Zero();
      for (size_t k = 0; k < 3; ++k) {
        name[face.corners[k]] = weights[k];
        at += weights[k] * corners[face.corners[k]] / (n * std::sqrt(8));
        lattice += weights[k] * face.lattice[k] / n;
      }
      const auto [place, is_new] = vertex_of.try_emplace(name, static_cast<int>(vertices.size()));
      if (is_new) {
        vertices.push_back(at);
        rolled.emplace_back(basis * lattice);
      }
      return place->second;
    };
    for (int i = 0; i < n; ++i) {
      for (int j = 0; i + j < n; ++j) {
        triangles.emplace_back(vertex(i, j), vertex(i + 1, j), vertex(i, j + 1));
        if (i + j + 1 == n) continue;
        triangles.emplace_back(vertex(i + 1, j), vertex(i + 1, j + 1), vertex(i, j + 1));
      }
    }
  }
  RolledTetrahedron result;
  result.mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
  result.rolled.resize(2, static_cast<Eigen::Index>(vertices.size()));
  for (size_t v = 0; v < vertices.size(); ++v) {
    result.mesh.vertices.col(static_cast<Eigen::Index>(v)) = vertices[v];
    result.rolled.col(static_cast<Eigen::Index>(v)) = rolled[v];
  }
  result.mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (size_t t = 0; t < triangles.size(); ++t) {
    result.mesh.triangles.col(static_cast<Eigen::Index>(t)) = triangles[t];
  }
  return result;
}

TEST(ExactGeodesicDistance, OnATetrahedronIsThatOfItsUnfoldings) {
  const RolledTetrahedron solid = tetrahedron(7);
  for (const SurfacePoint& source :
       {SurfacePoint{0, {0.2, 0.3, 0.5}}, SurfacePoint{17, {0.2, 0.3, 0.5}},
        SurfacePoint{17, {0.3, 0.7, 0}}}) {
    // All triangles of one face lie together in the plane, apart from those at a fold.
    Eigen::Vector2d from = Eigen::Vector2d::Zero();
    for (int k = 0; k < 3; ++k) {
      from += source.barycentric[k] * solid.rolled.col(solid.mesh.triangles(k, source.triangle));
    }
    const GeodesicDistance geodesic = exact(solid.mesh, {source});
    for (Eigen::Index v = 0; v < geodesic.distance.size(); ++v) {
      double truth = kInf;
      for (const double sign : {-1.0, 1.0}) {
        for (int i = -3; i <= 3; ++i) {
          for (int j = -3; j <= 3; ++j) {
            const Eigen::Vector2d image =
                sign * solid.rolled.col(v) + Eigen::Vector2d(2 * i + j, 2 * j * std::sqrt(0.75));
            truth = std::min(truth, (image - from).norm());
          }
        }
      }
      EXPECT_NEAR(geodesic.distance[v], truth, kAccuracy) << v;
    }
  }
}

TEST(ExactGeodesicDistance, IsTheSameBackwards) {
  for (const TriangleMesh& mesh : {test::bumpy(1500, 2.0), test::glove(9.0)}) {
    std::mt19937 random(7);
    std::uniform_int_distribution<int> any(0, static_cast<int>(mesh.triangles.cols()) - 1);
    std::vector<SurfacePoint> places;
    std::vector<int> vertices;
    for (int i = 0; i < 8; ++i) {
      places.push_back({.triangle = any(random), .barycentric = {0, 1, 0}});
      vertices.push_back(mesh.triangles(1, places.back().triangle));
    }
    Eigen::MatrixXd distances(8, 8);
    for (int i = 0; i < 8; ++i) {
      distances.col(i) = exact(mesh, {places[static_cast<size_t>(i)]}).distance(vertices);
    }
    EXPECT_LT((distances - distances.transpose()).cwiseAbs().maxCoeff(),
              kAccuracy * distances.maxCoeff());
  }
}

TEST(ExactGeodesicDistance, OfManySourcesIsTheLeastOfTheDistancesOfEach) {
  const TriangleMesh mesh = test::bumpy(2000, 0.25);
  std::vector<SurfacePoint> sources;
  for (const int t : {37, 400, 777, 1100, 1501, 1800}) {
    sources.push_back({.triangle = t, .barycentric = {0.3, 0.3, 0.4}});
  }
  const GeodesicDistance together = exact(mesh, sources);
  Eigen::MatrixXd each(mesh.vertices.cols(), 6);
  for (int i = 0; i < 6; ++i) each.col(i) = exact(mesh, {sources[static_cast<size_t>(i)]}).distance;
  EXPECT_LT(largest_error(mesh, together.distance, each.rowwise().minCoeff()), kAccuracy);
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    EXPECT_NEAR(each(v, together.label[v]), together.distance[v], kAccuracy * together.distance[v]);
  }
}

TEST(ExactGeodesicDistance, StopsAtTheRadius) {
  const TriangleMesh mesh = test::glove(9.0);
  const std::vector<SurfacePoint> sources = {{37, {0.2, 0.3, 0.5}}, {800, {0.2, 0.3, 0.5}}};
  constexpr double kRadius = 43.7;
  const GeodesicDistance whole = exact(mesh, sources);
  const GeodesicDistance part = exact(mesh, sources, kRadius);
  int beyond = 0;
  for (Eigen::Index v = 0; v < mesh.vertices.cols(); ++v) {
    if (whole.distance[v] <= kRadius) {
      EXPECT_NEAR(part.distance[v], whole.distance[v], kAccuracy * kRadius);
      EXPECT_EQ(part.label[v], whole.label[v]);
    } else {
      ++beyond;
      EXPECT_EQ(part.distance[v], kInf);
      EXPECT_EQ(part.label[v], -1);
    }
  }
  EXPECT_GT(beyond, 10);
  EXPECT_LT(beyond, mesh.vertices.cols() - 10);
}

TEST(ExactGeodesicDistance, PassesWhereSheetsMeetAtOneVertexOfTheirBorders) {
  TriangleMesh bow_tie;
  bow_tie.vertices.resize(3, 6);
  bow_tie.vertices << 0, 2, 2, -2, -2, 9,  //
      0, 1, -1, 1, -1, 9,                  //
      0, 0, 0, 0, 0, 9;                    // the last is in no triangle
  bow_tie.triangles.resize(3, 2);
  bow_tie.triangles << 0, 0, 2, 3, 1, 4;
  const GeodesicDistance geodesic = exact(bow_tie, {corner_point(0, 1)});
  EXPECT_NEAR(geodesic.distance[3], 2 * std::sqrt(5), kAccuracy);
  EXPECT_NEAR(geodesic.distance[4], 2 * std::sqrt(5), kAccuracy);
  EXPECT_EQ(geodesic.distance[5], kInf);
  EXPECT_EQ(geodesic.label[5], -1);
}

TEST(ExactGeodesicDistance, PassesWhereClosedSurfacesMeetAtOneVertex) {
  TriangleMesh twins;  // two tetrahedra
  twins.vertices.resize(3, 7);
  twins.vertices << 0, 1, 0, 0, -1, 0, 0,  //
      0, 0, 1, 0, 0, -1, 0,                //
      0, 0, 0, 1, 0, 0, -1;
  twins.triangles.resize(3, 8);
  twins.triangles << 0, 0, 0, 1, 0, 0, 0, 4,  //
      2, 1, 3, 2, 5, 4, 6, 5,                 //
      1, 3, 2, 3, 4, 6, 5, 6;
  const GeodesicDistance geodesic = exact(twins, {corner_point(0, 1)});
  EXPECT_NEAR(geodesic.distance[0], 1, kAccuracy);
  for (const int v : {4, 5, 6}) EXPECT_NEAR(geodesic.distance[v], 2, kAccuracy);
}

TEST(ExactGeodesicDistance, ScalesExactlyWithTheUnitOfLengthAndMovesAlong) {
  const TriangleMesh mesh = test::bumpy(1000, 0.25);
  const std::vector<SurfacePoint> sources = {{7, {0.2, 0.3, 0.5}}, {901, {0.2, 0.3, 0.5}}};
  const GeodesicDistance expected = exact(mesh, sources);
  for (const double factor : {0x1p-700, 0x1p-20, 0x1p20, 0x1p700}) {
    const GeodesicDistance scaled = exact(test::scaled(mesh, factor), sources);
    EXPECT_EQ(scaled.distance, factor * expected.distance);
    EXPECT_EQ(scaled.label, expected.label);
  }
  Eigen::Isometry3d motion(Eigen::AngleAxisd(1.1, Vector3d(0.3, 0.5, -0.7).normalized()));
  motion.pretranslate(Vector3d(100.1, -20.7, 3.3));
  EXPECT_LT(
      largest_error(mesh, exact(test::moved(mesh, motion), sources).distance, expected.distance),
      kAccuracy);
}

TEST(ExactGeodesicDistance, FarFromTheOriginIsThatOfTheRoundedMesh) {
  TriangleMesh far = test::bumpy(1000, 0.25);
  const std::vector<SurfacePoint> sources = {{7, {0.2, 0.3, 0.5}}, {901, {0.2, 0.3, 0.5}}};
  const Vector3d offset = Vector3d::Constant(0x1p30);
  far.vertices.colwise() += offset;
  TriangleMesh near = far;
  near.vertices.colwise() -= offset;  // without rounding
  EXPECT_LT(largest_error(near, exact(far, sources).distance, exact(near, sources).distance),
            kAccuracy);
}

TEST(ExactGeodesicDistance, OfSourcesInOnePlaceGoesToTheLowest) {
  const TriangleMesh mesh = test::bumpy(1000, 0.25);
  for (const Vector3d& barycentric :
       {Vector3d(0.2, 0.3, 0.5), Vector3d(0.4, 0, 0.6), Vector3d(0, 1, 0)}) {
    const SurfacePoint source{.triangle = 555, .barycentric = barycentric};
    EXPECT_TRUE((exact(mesh, {source, source}).label.array() == 0).all());
  }
}

TEST(ExactGeodesicDistance, RefusesWhatIsNoManifoldOrHasNoArea) {
  const auto refused = [](const TriangleMesh& mesh) {
    return refusal([&] { return exact(mesh, {corner_point(0, 0)}); });
  };
  TriangleMesh flat = test::flat_sheet(3, 3, 1);
  flat.vertices(0, 5) = 2;  // onto vertex 6, its neighbour
  EXPECT_NE(refused(flat).find("has no area"), std::string::npos);
  EXPECT_EQ(refused(flat).find("::"), std::string::npos)
      << "names of C++ mean nothing to most users";

  TriangleMesh turned = test::flat_sheet(3, 3, 1);
  turned.triangles.col(4).reverseInPlace();
  EXPECT_NE(refused(turned).find("turned over"), std::string::npos);
}

TEST(ExactGeodesicDistance, TellsItsProgressAndEndsWhenTold) {
  const TriangleMesh mesh = test::icosphere(5, 30);
  const std::vector<SurfacePoint> source = {{0, {1, 0, 0}}};
  std::vector<std::pair<int, int>> seen;
  GeodesicOptions options{.method = GeodesicMethod::exact,
                          .progress = [&](int done, int total) { seen.emplace_back(done, total); }};
  const Eigen::VectorXd distance = geodesic_distance(mesh, source, options).distance;
  EXPECT_EQ(distance, exact(mesh, source).distance);
  ASSERT_GT(seen.size(), 3U);
  EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
  EXPECT_LT(seen.front().first, mesh.vertices.cols() / 2);
  for (const auto& [done, total] : seen) EXPECT_EQ(total, mesh.vertices.cols());
  EXPECT_EQ(seen.back().first, seen.back().second);
  options.progress = [](int, int) { throw std::domain_error("stop"); };
  EXPECT_THROW((void)geodesic_distance(mesh, source, options), std::domain_error);
}

}  // namespace
}  // namespace palpate::geometry
