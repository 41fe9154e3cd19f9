// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/zipper_scans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

#include "dense_sampling.h"
#include "mesh_corpus.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_defects.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/surface_query.h"
#include "range_map_scene.h"
#include "refusal.h"
#include "registration/registration_testing.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

constexpr double kDepthNoise = 0.1;  // [mm] standard deviation of a depth

/// Scan that a camera there makes of an object.
Scan scan_from(const TriangleMesh& object, const Eigen::Isometry3d& T_object_camera, int width,
               unsigned seed) {
  RangeMap map =
      test::render(test::moved(object, T_object_camera.inverse()), test::bumpy_camera(width));
  test::add_noise(map, kDepthNoise, seed);
  return {.mesh = mesh_range_map(map).mesh, .T_object_scan = T_object_camera};
}

/// Two views of `bumpy`, 15 degrees apart and each 100 mm to one side, so that they see 2/3 of it
/// together and each the rest on its side.
std::vector<Scan> two_views_of(const TriangleMesh& object, int width = 160) {
  const Eigen::Translation3d middle(0, 0, 690);
  std::vector<Scan> scans;
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Isometry3d T_object_camera =
        middle * Eigen::AngleAxisd(-side * 7.5 * test::kDegree, Vector3d::UnitY()) *
        middle.inverse() * Eigen::Translation3d(side * 100.3, side * 3.1, 0);
    scans.push_back(scan_from(object, T_object_camera, width, side > 0 ? 1 : 2));
  }
  return scans;
}

/// A camera that looks at the origin from a direction, 400 mm away.
Eigen::Isometry3d towards_origin(const Vector3d& from) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.linear().col(2) = -from.normalized();
  T.linear().col(0) = from.unitOrthogonal();
  T.linear().col(1) = T.linear().col(2).cross(T.linear().col(0));
  T.translation() = 400 * from.normalized();
  return T;
}

Eigen::Matrix3Xd centroids(const TriangleMesh& mesh) {
  Eigen::Matrix3Xd middle(3, mesh.triangles.cols());
  for (Eigen::Index t = 0; t < middle.cols(); ++t) {
    middle.col(t) = mesh.vertices(Eigen::all, mesh.triangles.col(t)).rowwise().mean();
  }
  return middle;
}

/// Number of triangles that face the other way than their surface.
int folded(const TriangleMesh& mesh, const TriangleMesh& truth) {
  const ClosestPoints closest = closest_points(SurfaceQuery(truth), centroids(mesh));
  const Eigen::Matrix3Xd there = triangle_normals(truth);
  const Eigen::Matrix3Xd here = triangle_normals(mesh);
  int count = 0;
  for (Eigen::Index t = 0; t < here.cols(); ++t) {
    count += !(here.col(t).dot(there.col(closest.triangles[t])) > 0);
  }
  return count;
}

/// Triangles of the truth that a scan saw: their middle is not farther from it than noise and
/// chords explain.
std::vector<int> seen_triangles(const TriangleMesh& truth, const std::vector<Scan>& scans) {
  std::vector<int> found;
  const Eigen::Matrix3Xd middle = centroids(truth);
  Eigen::VectorXd distances =
      Eigen::VectorXd::Constant(middle.cols(), std::numeric_limits<double>::infinity());
  for (const Scan& scan : scans) {
    const SurfaceQuery query(test::moved(scan.mesh, scan.T_object_scan));
    distances = distances.cwiseMin(closest_points(query, middle).distances);
  }
  for (int t = 0; t < middle.cols(); ++t) {
    if (distances[t] < 5 * kDepthNoise) found.push_back(t);
  }
  return found;
}

/// Of these triangles of `bumpy` those farther than `margin` (a fraction of its width) inside its
/// outline and outside its holes.
std::vector<int> away_from_border(const TriangleMesh& bumpy, const std::vector<int>& triangles,
                                  double margin) {
  const Eigen::Matrix3Xd middle = centroids(bumpy);
  std::vector<int> found;
  for (const int i : triangles) {
    const double s = 0.5 + 1.2 * middle(0, i) / middle(2, i);
    const double t = 0.375 + 1.2 * middle(1, i) / middle(2, i);
    if (std::min({s, 1 - s, t, 0.75 - t}) > margin &&
        std::hypot(s - 0.25, t - 0.25) > 0.06 + margin &&
        std::hypot(s - 0.75, t - 0.5) > 0.04 + margin) {
      found.push_back(i);
    }
  }
  return found;
}

void expect_one_sound_surface(const ZipperedScans& zippered, std::size_t loops) {
  EXPECT_TRUE(find_defects(zippered.mesh).empty());
  EXPECT_EQ(connected_components(zippered.mesh).count, 1);
  EXPECT_EQ(boundary_loops(zippered.mesh).size(), loops);
}

TEST(ZipperScans, OfASheetFromTwoSidesAreTheSheet) {
  const TriangleMesh sheet = test::bumpy(100'000);
  const std::vector<Scan> scans = two_views_of(sheet);
  const ZipperedScans zippered = zipper_scans(scans);
  expect_one_sound_surface(zippered, 3);  // the outline and the two holes
  EXPECT_EQ(folded(zippered.mesh, sheet), 0);
  EXPECT_GT(zippered.seam, 100);
  EXPECT_GT(zippered.dropped, 10'000);
  const std::vector<int> union_of_scans = seen_triangles(sheet, scans);
  const double area = surface_area({sheet.vertices, sheet.triangles(Eigen::all, union_of_scans)});
  EXPECT_NEAR(surface_area(zippered.mesh), area, 0.01 * area);
  // The noise, and the chords of a grid 4 mm wide.
  const test::Errors there =
      test::errors_of(closest_points(SurfaceQuery(sheet), centroids(zippered.mesh)).distances);
  EXPECT_LT(there.rms, zippered.spacing / 20);
  EXPECT_LT(there.largest, zippered.spacing / 3);
  // No gap is left except at the border, where triangles that straddle a seam may be missing.
  const std::vector<int> inside = away_from_border(sheet, union_of_scans, 0.015);
  ASSERT_GT(inside.size(), 80'000U);
  const test::Errors back = test::errors_of(
      closest_points(SurfaceQuery(zippered.mesh), centroids(sheet)(Eigen::all, inside)).distances);
  EXPECT_LT(back.rms, zippered.spacing / 20);
  EXPECT_LT(back.largest, zippered.spacing / 3);
}

TEST(ZipperScans, OfACapAndOfThreeSidesOfABallHaveOneOutline) {
  const TriangleMesh ball = test::icosphere(6, 100);
  std::vector<Scan> scans;
  for (const double angle : {-30.0, 30.0}) {
    const Vector3d from(std::sin(angle * test::kDegree), 0.01, std::cos(angle * test::kDegree));
    scans.push_back(scan_from(ball, towards_origin(from), 160, angle > 0 ? 1 : 2));
  }
  const auto expect_on_ball = [](const ZipperedScans& zippered) {
    const Eigen::Matrix3Xd middle = centroids(zippered.mesh);
    const test::Errors there = test::errors_of(middle.colwise().norm().array() - 100);
    EXPECT_LT(there.rms, zippered.spacing / 20);
    EXPECT_LT(there.largest, zippered.spacing / 4);
  };
  const ZipperedScans cap = zipper_scans(scans);
  expect_one_sound_surface(cap, 1);
  expect_on_ball(cap);
  scans.push_back(scan_from(ball, towards_origin({0.1, 1, 0.2}), 160, 3));
  const ZipperedScans three = zipper_scans(scans);
  expect_one_sound_surface(three, 1);
  expect_on_ball(three);
  EXPECT_GT(surface_area(three.mesh), 1.2 * surface_area(cap.mesh));
}

TEST(ZipperScans, OfFlatSheetsCoverTheirUnionOnce) {
  // A sheet of 40 x 30 and one turned by a quarter of a right angle that reaches out of it: no seam
  // may fold, so the area is that of the union, except for the part that is lost at the outline.
  const TriangleMesh first = test::flat_sheet(40, 30, 1);
  const TriangleMesh second =
      test::moved(first, Eigen::Translation3d(22.3, -4.1, 0) *
                             Eigen::AngleAxisd(std::numbers::pi / 8, Vector3d::UnitZ()));
  const ZipperedScans zippered = zipper_scans(std::vector<Scan>{{.mesh = first}, {.mesh = second}});
  expect_one_sound_surface(zippered, 1);
  EXPECT_GT(triangle_normals(zippered.mesh).row(2).minCoeff(), 0.999);
  // Independent: points of a fine grid that are in one of the rectangles.
  int inside = 0;
  const Eigen::Isometry2d T_second_first =
      (Eigen::Translation2d(22.3, -4.1) * Eigen::Rotation2Dd(std::numbers::pi / 8)).inverse();
  constexpr double kSide = 0.05;
  for (double x = -20; x < 80; x += kSide) {
    for (double y = -20; y < 60; y += kSide) {
      const Eigen::Vector2d p(x, y);
      const auto in_sheet = [](const Eigen::Vector2d& q) {
        return q.x() > 0 && q.x() < 40 && q.y() > 0 && q.y() < 30;
      };
      inside += in_sheet(p) || in_sheet(T_second_first * p);
    }
  }
  EXPECT_NEAR(surface_area(zippered.mesh), inside * kSide * kSide, 0.005 * inside * kSide * kSide);
}

TEST(ZipperScans, KeepTheMeasuredVertices) {
  const std::vector<Scan> scans = two_views_of(test::bumpy(30'000), 60);
  const ZipperedScans zippered = zipper_scans(scans);
  ASSERT_EQ(zippered.source.size(), static_cast<std::size_t>(zippered.mesh.vertices.cols()));
  for (std::size_t v = 0; v < zippered.source.size(); ++v) {
    const auto [scan, vertex] = zippered.source[v];
    const Scan& from = scans[static_cast<std::size_t>(scan)];
    EXPECT_LT((from.T_object_scan * from.mesh.vertices.col(vertex) -
               zippered.mesh.vertices.col(static_cast<Eigen::Index>(v)))
                  .norm(),
              1e-12 * 700);
  }
}

TEST(ZipperScans, KeepTheScanThatIsFartherFromItsBorder) {
  // They overlap for x in [20.3, 40]. The later one, from its side, must be ahead by some spacings.
  const TriangleMesh sheet = test::flat_sheet(40, 30, 1);
  const Scan left{.mesh = sheet};
  const Scan right{.mesh = sheet,
                   .T_object_scan = Eigen::Isometry3d(Eigen::Translation3d(20.3, 0.4, 0))};
  for (const bool left_first : {true, false}) {
    const ZipperedScans zippered =
        zipper_scans(left_first ? std::vector<Scan>{left, right} : std::vector<Scan>{right, left});
    const double seam = left_first ? 32.15 : 28.15;  // where the distances differ by 4
    int checked = 0;
    for (std::size_t v = 0; v < zippered.source.size(); ++v) {
      const Vector3d point = zippered.mesh.vertices.col(static_cast<Eigen::Index>(v));
      if (std::abs(point.y() - 15) > 2 || std::abs(point.x() - seam) < 1.5) continue;
      const bool from_left = (zippered.source[v].scan == 0) == left_first;
      EXPECT_EQ(from_left, point.x() < seam) << point.transpose();
      ++checked;
    }
    EXPECT_GT(checked, 200);
  }
}

TEST(ZipperScans, OfOneScanAreTheScan) {
  const std::vector<Scan> scans = {two_views_of(test::bumpy(30'000), 60)[0]};
  const ZipperedScans zippered = zipper_scans(scans);
  EXPECT_EQ(zippered.mesh.triangles, scans[0].mesh.triangles);
  EXPECT_TRUE(
      zippered.mesh.vertices.isApprox(scans[0].T_object_scan * scans[0].mesh.vertices, 1e-15));
  EXPECT_EQ(zippered.dropped, 0);
  EXPECT_EQ(zippered.seam, 0);
  // The same scan once more adds nothing.
  const ZipperedScans twice = zipper_scans(std::vector<Scan>{scans[0], scans[0]});
  EXPECT_EQ(twice.mesh.triangles, scans[0].mesh.triangles);
  EXPECT_EQ(twice.dropped, scans[0].mesh.triangles.cols());
}

TEST(ZipperScans, ThatDoNotOverlapStayApart) {
  const TriangleMesh sheet = test::flat_sheet(10, 10, 1);
  const auto at = [&](double x, double z) {
    return Scan{.mesh = sheet, .T_object_scan = Eigen::Isometry3d(Eigen::Translation3d(x, 0.1, z))};
  };
  for (const Scan& other : {at(13, 0), at(3, 4)}) {
    const ZipperedScans apart = zipper_scans(std::vector<Scan>{at(0, 0), other});
    EXPECT_EQ(connected_components(apart.mesh).count, 2);
    EXPECT_EQ(apart.mesh.triangles.cols(), 400);
    EXPECT_EQ(apart.seam, 0);
  }
  // Scans that end in the same points are joined there.
  const ZipperedScans joined = zipper_scans(std::vector<Scan>{at(0, 0), at(10, 0)});
  expect_one_sound_surface(joined, 1);
  EXPECT_NEAR(surface_area(joined.mesh), 200, 1e-9);
  // The two sides of a thin object: within reach, but facing away from each other.
  Scan below = at(3, -0.5);
  below.mesh.triangles.row(1).swap(below.mesh.triangles.row(2));
  const ZipperedScans sides = zipper_scans(std::vector<Scan>{at(0, 0), below});
  EXPECT_EQ(connected_components(sides.mesh).count, 2);
  EXPECT_EQ(sides.dropped, 0);
  // As near and facing the same way they are one surface, with a step.
  const ZipperedScans step = zipper_scans(std::vector<Scan>{at(0, 0), at(3, -0.5)});
  EXPECT_EQ(connected_components(step.mesh).count, 1);
  EXPECT_EQ(boundary_loops(step.mesh).size(), 1U);
}

TEST(ZipperScans, DependLittleOnTheOrder) {
  std::vector<Scan> scans = two_views_of(test::bumpy(30'000), 100);
  const ZipperedScans there = zipper_scans(scans);
  std::swap(scans[0], scans[1]);
  const ZipperedScans back = zipper_scans(scans);
  expect_one_sound_surface(there, 3);
  expect_one_sound_surface(back, 3);
  EXPECT_NEAR(surface_area(there.mesh), surface_area(back.mesh), 0.003 * surface_area(back.mesh));
  const test::Errors errors_between =
      test::errors_of(closest_points(SurfaceQuery(there.mesh), centroids(back.mesh)).distances);
  EXPECT_LT(errors_between.rms, there.spacing / 10);
}

TEST(ZipperScans, MoveWithTheObjectAndWithTheUnit) {
  const std::vector<Scan> scans = two_views_of(test::bumpy(30'000), 60);
  const ZipperedScans as_is = zipper_scans(scans);
  const Eigen::Isometry3d T = Eigen::Translation3d(31.7, -11.3, 5.9) *
                              Eigen::AngleAxisd(1.1, Vector3d(0.3, -0.5, 0.8).normalized());
  std::vector<Scan> moved = scans;
  for (Scan& scan : moved) scan.T_object_scan = T * scan.T_object_scan;
  const ZipperedScans elsewhere = zipper_scans(moved);
  EXPECT_EQ(elsewhere.mesh.triangles, as_is.mesh.triangles);
  EXPECT_LT((elsewhere.mesh.vertices - T * as_is.mesh.vertices).cwiseAbs().maxCoeff(), 1e-9);
  for (const double unit : {0x1p-20, 0x1p10}) {
    std::vector<Scan> in_unit = scans;
    for (Scan& scan : in_unit) {
      scan.mesh.vertices *= unit;
      scan.T_object_scan.translation() *= unit;
    }
    const ZipperedScans other = zipper_scans(in_unit);
    EXPECT_EQ(other.mesh.triangles, as_is.mesh.triangles);
    EXPECT_EQ(other.mesh.vertices, unit * as_is.mesh.vertices);
    EXPECT_EQ(other.spacing, unit * as_is.spacing);
  }
}

TEST(ZipperScans, RefuseWhatIsNoScan) {
  const auto refused = [](const std::vector<Scan>& scans, const ZipperScansOptions& options = {}) {
    return refusal([&] { return zipper_scans(scans, options); });
  };
  const auto says = [](const std::string& message, const char* part) {
    EXPECT_NE(message.find(part), std::string::npos) << message;
  };
  const std::vector<Scan> good(2, {.mesh = test::icosphere(1, 30)});
  says(refused({}), "no scan");
  says(refused(good, {.reach = 0}), "reach");
  says(refused(good, {.reach = std::nan("")}), "reach");
  says(refused(good, {.reach = std::numeric_limits<double>::infinity()}), "finite");
  std::vector<Scan> bad = good;
  bad[1].T_object_scan.translation().x() = std::nan("");
  says(refused(bad), "scan 1: T_object_scan");
  bad = good;
  bad[1].mesh.vertices(1, 3) = std::nan("");
  says(refused(bad), "scan 1");
  bad = good;
  bad[1].mesh.triangles.col(5).swap(bad[1].mesh.triangles.col(6));
  std::swap(bad[1].mesh.triangles(0, 5), bad[1].mesh.triangles(1, 5));
  says(refused(bad), "scan 1 is not manifold");
  says(refused(bad), "repair_mesh");
  says(refused({{.mesh = test::icosphere(1, 0)}}), "no length");
}

}  // namespace
}  // namespace palpate::geometry
