// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_distance.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <string>

#include "dense_sampling.h"
#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

/// Roundings of coordinates of some 100 mm.
constexpr double kDistanceRounding = 1e-12;

Eigen::Isometry3d awkward_motion() {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.rotate(Eigen::AngleAxisd(0.7, Eigen::Vector3d(1, 2, 3).normalized()));
  T.pretranslate(Eigen::Vector3d(-300.1, 41.7, 1000.3));
  return T;
}

/// A flat sheet in z = 0 that reaches far around the first 30 mm, its triangles unlike others.
TriangleMesh flat_sheet_around() {
  TriangleMesh sheet = test::flat_sheet(9, 9, 11.3);
  sheet.vertices.topRows(2).array() -= 33.3;
  return sheet;
}

TriangleMesh raised(TriangleMesh mesh, double height) {
  mesh.vertices.row(2).array() += height;
  return mesh;
}

TEST(OneSidedHausdorffDistance, OfParallelPlanesIsTheirOffset) {
  // Different triangulations, the measured one within the other's outline.
  const TriangleMesh wide = flat_sheet_around();
  const TriangleMesh sheet = raised(test::flat_sheet(7, 5, 3.1), 0.7);
  const LargestDistance distance = one_sided_hausdorff_distance(sheet, wide);
  EXPECT_NEAR(distance.lower, 0.7, kDistanceRounding);
  EXPECT_NEAR(distance.upper, 0.7, kDistanceRounding);
}

TEST(OneSidedHausdorffDistance, FindsWhatVerticesAloneMiss) {
  // One triangle whose corners touch the top rim of a deep pit: furthest is not a corner.
  TriangleMesh pit;
  pit.vertices.resize(3, 4);
  pit.vertices << 0, 30, 0, 10,  //
      0, 0, 30, 10,              //
      0, 0, 0, -9;
  pit.triangles.resize(3, 3);
  pit.triangles << 0, 1, 2,  //
      1, 2, 0,               //
      3, 3, 3;
  TriangleMesh lid;
  lid.vertices = pit.vertices.leftCols(3);
  lid.triangles.resize(3, 1);
  lid.triangles << 0, 1, 2;
  const LargestDistance distance = one_sided_hausdorff_distance(lid, pit, {.max_gap = 1e-4});
  EXPECT_LE(distance.upper - distance.lower, 1e-4 * distance.lower);
  // The centre of the sphere that touches the three walls and lies in the lid's plane: by symmetry
  // x = y, and d = 9 x / sqrt(181) to the walls through the legs, and to the one through the
  // hypotenuse, 9 (30 - 2 x) / sqrt(2 * 81 + 10^2).
  const double leg = 9 / std::sqrt(181.0);
  const double hypotenuse = 9 / std::sqrt(2 * 81 + 100.0);
  const double x = 30 * hypotenuse / (leg + 2 * hypotenuse);
  EXPECT_NEAR(distance.lower, leg * x, 1e-4 * leg * x);
  EXPECT_NEAR(distance.at.x(), x, 0.01);
}

TEST(HausdorffDistance, OfASphereAndALargerOneIsTheDifferenceOfTheRadii) {
  const TriangleMesh small = test::icosphere(4, 10);
  const TriangleMesh large = test::icosphere(4, 10.7);
  const HausdorffDistance distance = hausdorff_distance(small, large, {.max_gap = 1e-3});
  // The facets lie below the sphere by at most a sagitta: (edge / radius)^2 / 6 of the radius.
  const double sagitta = 10.7 * 0.075 * 0.075 / 6;
  EXPECT_NEAR(distance.a_to_b.lower, 0.7, sagitta);
  EXPECT_NEAR(distance.b_to_a.lower, 0.7, sagitta);
  EXPECT_LE(distance.upper - distance.lower, 1e-3 * distance.upper);
}

TEST(HausdorffDistance, OfAPartAndTheWholeIsOneSided) {
  TriangleMesh whole = test::flat_sheet(10, 10, 2.3);
  TriangleMesh part = whole;
  part.triangles.conservativeResize(3, 60);  // three rows of ten
  const HausdorffDistance distance = hausdorff_distance(part, whole);
  EXPECT_LT(distance.a_to_b.upper, kDistanceRounding);
  EXPECT_NEAR(distance.b_to_a.lower, 7 * 2.3, kDistanceRounding);
  EXPECT_EQ(distance.upper, distance.b_to_a.upper);
}

TEST(HausdorffDistance, IsSymmetricAndZeroForTheSameSurface) {
  const TriangleMesh a = test::bumpy(2000, 0.25);
  const TriangleMesh b = test::bumpy(900);
  const HausdorffDistance one = hausdorff_distance(a, b);
  const HausdorffDistance other = hausdorff_distance(b, a);
  EXPECT_EQ(one.lower, other.lower);
  EXPECT_EQ(one.upper, other.upper);
  EXPECT_EQ(one.a_to_b.upper, other.b_to_a.upper);
  EXPECT_LT(hausdorff_distance(a, a).upper, 1e-9 * bounding_diagonal(a));
}

TEST(HausdorffDistance, HoldsAgainstDenseSampling) {
  const std::vector<std::pair<TriangleMesh, TriangleMesh>> pairs = {
      {test::bumpy(600, 0.25), test::bumpy(300)},
      {test::glove(14), test::glove(11)},
      {test::closed_sheet(20, 12, 6), test::closed_sheet(15, 9, 8)},
      {test::random_triangles(60, 10, 1), test::random_triangles(40, 10, 2)}};
  for (const auto& [a, b] : pairs) {
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      const LargestDistance bounds = one_sided_hausdorff_distance(from, to);
      const test::SampledDistance sampled = test::sampled_distance(from, to, 8000);
      EXPECT_LE(sampled.largest, bounds.upper + kDistanceRounding);
      EXPECT_GE(sampled.largest + sampled.spacing, bounds.lower);
      EXPECT_LE(bounds.upper, 1.01 * bounds.lower);
      EXPECT_NEAR(test::brute_force_distance(bounds.at, to), bounds.lower, kDistanceRounding);
    }
  }
}

TEST(HausdorffDistance, MovesWithTheMeshesAndScalesWithThem) {
  const TriangleMesh a = test::glove(12);
  const TriangleMesh b = test::glove(9);
  const HausdorffDistance here = hausdorff_distance(a, b);
  const HausdorffDistance there =
      hausdorff_distance(test::moved(a, awkward_motion()), test::moved(b, awkward_motion()));
  EXPECT_NEAR(there.lower, here.lower, 0.01 * here.upper) << "the gap that is allowed";
  for (const double unit : {0x1p-20, 0x1p20}) {
    const HausdorffDistance other =
        hausdorff_distance(test::scaled(a, unit), test::scaled(b, unit));
    EXPECT_EQ(other.lower, unit * here.lower);
    EXPECT_EQ(other.upper, unit * here.upper);
  }
}

/// Places far from the origin [mm]: 10 km away, UTM coordinates, geocentric ones, powers of two.
std::vector<Eigen::Vector3d> far_places() {
  return {{6e6, 6e6, 6e6}, {465e6, 5632e6, 120e3},    {4100e6, 620e6, 4800e6},
          {1e7, 1e7, 1e7}, {-0x1p30, 0x1p30, 0x1p30}, {0x1p36, -0x1p36, 0x1p36}};
}

TEST(HausdorffDistance, IsTheSameFarFromTheOrigin) {
  for (const Eigen::Vector3d& place : far_places()) {
    const auto far = [&](TriangleMesh mesh) {
      mesh.vertices.colwise() += place;
      return mesh;
    };
    // The meshes after their coordinates were rounded, moved back exactly.
    const auto back = [&](TriangleMesh mesh) {
      mesh.vertices.colwise() -= place;
      return mesh;
    };
    const TriangleMesh a = far(test::glove(14)), b = far(test::glove(11));
    for (const auto& [from, to] : {std::pair(a, b), std::pair(b, a)}) {
      const LargestDistance there = one_sided_hausdorff_distance(from, to);
      const LargestDistance here = one_sided_hausdorff_distance(back(from), back(to));
      EXPECT_LE(there.upper, 1.01 * there.lower) << place.transpose();
      EXPECT_LE(there.lower, here.upper + kDistanceRounding) << place.transpose();
      EXPECT_LE(here.lower, there.upper + kDistanceRounding) << place.transpose();
      const double rounding = 1e-15 * place.norm();  // of `at`
      EXPECT_NEAR(test::brute_force_distance(there.at - place, back(to)), there.lower,
                  rounding + kDistanceRounding);
      if (place != far_places().back()) continue;
      const test::SampledDistance sampled = test::sampled_distance(back(from), back(to), 2000);
      EXPECT_LE(sampled.largest, there.upper + kDistanceRounding);
      EXPECT_GE(sampled.largest + sampled.spacing, there.lower);
    }
  }
}

TEST(HausdorffDistance, HoldsForASurfaceOfManyScales) {
  const TriangleMesh star = test::star_of_many_scales();
  for (const TriangleMesh& other : {test::icosphere(1, 3e5), test::icosphere(2, 1.0)}) {
    for (const auto& [from, to] : {std::pair(star, other), std::pair(other, star)}) {
      const LargestDistance bounds = one_sided_hausdorff_distance(from, to);
      const test::SampledDistance sampled = test::sampled_distance(from, to, 2000);
      EXPECT_LE(bounds.upper, 1.01 * bounds.lower);
      constexpr double kRounding = 1e-9;  // of coordinates of 1e6 mm
      EXPECT_LE(sampled.largest, bounds.upper + kRounding);
      EXPECT_NEAR(test::brute_force_distance(bounds.at, to), bounds.lower, kRounding);
    }
  }
}

TEST(HausdorffDistance, BearsTrianglesWithoutArea) {
  TriangleMesh line;
  line.vertices.resize(3, 3);
  line.vertices << 1, 5, 3,  //
      2, 2, 2,               //
      0.5, 2.5, 1.5;
  line.triangles.resize(3, 1);
  line.triangles << 0, 1, 2;
  const LargestDistance distance =
      one_sided_hausdorff_distance(line, test::flat_sheet(10, 10, 1.0));
  EXPECT_NEAR(distance.lower, 2.5, kDistanceRounding);
  EXPECT_NEAR(distance.upper, 2.5, 0.026);
}

TEST(HausdorffDistance, RefusesWhatIsNoMeshOrGap) {
  const TriangleMesh sheet = test::flat_sheet(2, 2, 1);
  for (const double gap : {0.0, -0.1, 1.1, std::nan("")}) {
    EXPECT_THROW((void)hausdorff_distance(sheet, sheet, {.max_gap = gap}), InvalidInput);
    EXPECT_THROW((void)one_sided_hausdorff_distance(sheet, sheet, {.max_gap = gap}), InvalidInput);
  }
  EXPECT_THROW((void)hausdorff_distance(sheet, {}), InvalidInput);
  EXPECT_THROW((void)one_sided_hausdorff_distance({}, sheet), InvalidInput);
  EXPECT_THROW((void)one_sided_hausdorff_distance(test::scaled(sheet, 1e200), sheet), InvalidInput);
}

TEST(SurfaceDistances, OfATiltedPlaneAreThoseOfALinearFunction) {
  // z = 0.4 (x - 6) over 12 x 12: mean 0, mean square (0.4 * 12)^2 / 12, to a plane that is flat.
  // The distance to the flat plane is z.
  const TriangleMesh tilted =
      test::height_field(5, 7, 12.0 / 5, [](double x, double) { return 0.4 * (x - 6); });
  for (const int cells : {1, 500, 5000}) {
    const SurfaceDistances found = surface_distances(tilted, flat_sheet_around(), {.cells = cells});
    EXPECT_NEAR(found.mean, 0, 1e-12) << cells;
    EXPECT_NEAR(found.rms, 4.8 / std::sqrt(12.0), 1e-12) << cells;
    EXPECT_NEAR(found.area, 12 * 12 * 1.4 * std::hypot(1, 0.4), 1e-9) << cells;
    EXPECT_EQ(found.distance.size(), found.cells.triangles.cols());
  }
  const SurfaceDistances found = surface_distances(tilted, flat_sheet_around(), {.cells = 10000});
  EXPECT_NEAR(found.median, 1.2, 0.02);  // |z| is uniform on [0, 2.4]
  EXPECT_NEAR(found.p90, 2.16, 0.02);
}

TEST(SurfaceDistances, AreSignedByTheSideOfTheOther) {
  const TriangleMesh small = test::icosphere(2, 10);
  const TriangleMesh large = test::icosphere(2, 10.7);
  EXPECT_NEAR(surface_distances(small, large).mean, -0.7, 0.1);
  EXPECT_NEAR(surface_distances(large, small).mean, 0.7, 0.1);
}

TEST(SurfaceDistances, CellsCoverTheSurface) {
  const TriangleMesh mesh = test::glove(12);
  const SurfaceDistances found = surface_distances(mesh, mesh, {.cells = 10000});
  EXPECT_NEAR(static_cast<double>(found.cells.triangles.cols()), 10000, 3000);
  EXPECT_LT(found.rms, 1e-12);
  const SurfaceDistances of_cells = surface_distances(found.cells, mesh, {.cells = 1});
  EXPECT_NEAR(of_cells.area, found.area, 1e-9 * found.area);
  EXPECT_LT(of_cells.rms, 1e-12);
  // Their orientation is that of the mesh.
  EXPECT_GT(triangle_normals(found.cells).col(0).dot(triangle_normals(mesh).col(0)), 0.99);
}

TEST(SurfaceDistances, RefuseASurfaceWithoutAreaAndNoCells) {
  const TriangleMesh sheet = test::flat_sheet(2, 2, 1);
  EXPECT_THROW((void)surface_distances(sheet, sheet, {.cells = 0}), InvalidInput);
  EXPECT_THROW((void)surface_distances(test::scaled(sheet, 0), sheet), InvalidInput);
  EXPECT_THROW((void)surface_distances(sheet, sheet, {.cells = 100'000'001}), InvalidInput);
  EXPECT_THROW((void)surface_distances(sheet, {}), InvalidInput);
}

TEST(SurfaceDistances, RefuseWhatOverflows) {
  const TriangleMesh sheet = test::flat_sheet(2, 2, 1);
  const auto refused = [&](const TriangleMesh& from) {
    return refusal([&] { return surface_distances(from, sheet, {.cells = 10}); });
  };
  EXPECT_NE(refused(test::scaled(sheet, 1e155)).find("in mm?"), std::string::npos);
  EXPECT_NE(refused(test::scaled(sheet, 1e300)).find("in mm?"), std::string::npos);
  EXPECT_NE(refused(raised(sheet, 1e160)).find("in mm?"), std::string::npos);
}

TEST(DistancesToSurface, ArePositiveOnTheSideOfTheNormals) {
  TriangleMesh square;
  square.vertices.resize(3, 4);
  square.vertices << 0, 10, 10, 0,  //
      0, 0, 10, 10,                 //
      5, 5, 5, 5;
  square.triangles.resize(3, 2);
  square.triangles << 0, 0,  //
      1, 2,                  //
      2, 3;
  Eigen::Matrix3Xd points(3, 4);
  points << 3, 3, 13, std::nan(""),  //
      4, 4, 14, 0,                   //
      7.5, 1, 5, 0;
  const Eigen::VectorXd distances = distances_to_surface(points, square);
  EXPECT_DOUBLE_EQ(distances(0), 2.5);
  EXPECT_DOUBLE_EQ(distances(1), -4);
  EXPECT_DOUBLE_EQ(distances(2), 5);  // beyond the corner: 3 and 4 to the side
  EXPECT_TRUE(std::isnan(distances(3)));
}

TEST(DistancesInBoth, PartsOfOnlyOneSurfaceHaveNoDistance) {
  // A square of 2 mm at z = 5 in two triangles.
  TriangleMesh square;
  square.vertices.resize(3, 4);
  square.vertices << 0, 2, 2, 0, 0, 0, 2, 2, 5, 5, 5, 5;
  square.triangles.resize(3, 2);
  square.triangles << 0, 0, 1, 2, 2, 3;
  Eigen::Matrix3Xd points(3, 6);
  points.col(0) << 0.5, 1.5, 6;  // above it
  points.col(1) << 1, 1, 4.5;    // below the edge that both triangles share
  points.col(2) << 2.5, 1, 5.1;  // beside an edge of the border
  points.col(3) << -1, -1, 5;    // beside a corner
  points.col(4) << 1, 1.2, 9;    // far
  points.col(5) << std::nan(""), 0, 0;
  const Eigen::VectorXd distances = distances_in_both(points, square, 3);
  EXPECT_DOUBLE_EQ(distances(0), 1);
  EXPECT_DOUBLE_EQ(distances(1), 0.5);
  EXPECT_TRUE(distances.tail<4>().array().isNaN().all());
  EXPECT_DOUBLE_EQ(distances_in_both(points, square)(4), 4);
  EXPECT_THROW((void)distances_in_both(points, square, std::nan("")), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
