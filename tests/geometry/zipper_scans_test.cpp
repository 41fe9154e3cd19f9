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

#include "mesh_corpus.h"
#include "palpate/error.h"
#include "palpate/geometry/mesh_defects.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/surface_query.h"
#include "range_map_scene.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

constexpr double kNoise = 0.1;  // [mm] standard deviation of a depth
constexpr double kDegree = std::numbers::pi / 180;

/// What a camera there measures of an object.
Scan look(const TriangleMesh& object, const Eigen::Isometry3d& T_object_camera, int width,
          unsigned seed) {
  RangeMap map = test::render(test::moved(object, T_object_camera.inverse()),
                              test::bumpy_camera(width));
  test::add_noise(map, kNoise, seed);
  return {.mesh = mesh_range_map(map).mesh, .T_object_scan = T_object_camera};
}

/// Two views of `bumpy`, 15 degrees apart and each 100 mm to one side, so that they see 2/3 of it
/// together and each the rest on its side.
std::vector<Scan> two_views_of(const TriangleMesh& object, int width = 160) {
  const Eigen::Translation3d middle(0, 0, 690);
  std::vector<Scan> scans;
  for (const double side : {-1.0, 1.0}) {
    const Eigen::Isometry3d T_object_camera =
        middle * Eigen::AngleAxisd(-side * 7.5 * kDegree, Vector3d::UnitY()) * middle.inverse() *
        Eigen::Translation3d(side * 100.3, side * 3.1, 0);
    scans.push_back(look(object, T_object_camera, width, side > 0 ? 1 : 2));
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

struct Errors {
  double rms, largest;
};

Errors errors(const Eigen::VectorXd& distances) {
  return {std::sqrt(distances.squaredNorm() / static_cast<double>(distances.size())),
          distances.cwiseAbs().maxCoeff()};
}

/// Triangles that look the other way than the surface they are of.
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

/// Which triangles of the truth a scan saw: their middle is not farther from it than noise and
/// chords explain.
std::vector<int> seen(const TriangleMesh& truth, const std::vector<Scan>& scans) {
  std::vector<int> found;
  const Eigen::Matrix3Xd middle = centroids(truth);
  Eigen::VectorXd distances =
      Eigen::VectorXd::Constant(middle.cols(), std::numeric_limits<double>::infinity());
  for (const Scan& scan : scans) {
    const SurfaceQuery query(test::moved(scan.mesh, scan.T_object_scan));
    distances = distances.cwiseMin(closest_points(query, middle).distances);
  }
  for (int t = 0; t < middle.cols(); ++t) {
    if (distances[t] < 5 * kNoise) found.push_back(t);
  }
  return found;
}

TEST(ZipperScans, OfASheetFromTwoSidesAreTheSheet) {
  const TriangleMesh sheet = test::bumpy(200'000);
  const std::vector<Scan> scans = two_views_of(sheet);
  const ZipperedScans zippered = zipper_scans(scans);
  EXPECT_EQ(connected_components(zippered.mesh).count, 1);
  EXPECT_EQ(boundary_loops(zippered.mesh).size(), 3U);  // the outline and the two holes
  EXPECT_EQ(folded(zippered.mesh, sheet), 0);
  EXPECT_GT(zippered.seam, 100);
  EXPECT_GT(zippered.dropped, 10'000);
  const TriangleMesh truth{sheet.vertices, sheet.triangles(Eigen::all, seen(sheet, scans))};
  EXPECT_NEAR(surface_area(zippered.mesh), surface_area(truth), 0.01 * surface_area(truth));
  const Errors there =
      errors(closest_points(SurfaceQuery(sheet), centroids(zippered.mesh)).distances);
  const Errors back =
      errors(closest_points(SurfaceQuery(zippered.mesh), centroids(truth)).distances);
  EXPECT_LT(there.rms, zippered.spacing / 10);
  EXPECT_LT(back.rms, zippered.spacing / 10);
  EXPECT_LT(there.largest, zippered.spacing / 2);
  EXPECT_LT(back.largest, zippered.spacing / 2);
}

}  // namespace
}  // namespace palpate::geometry
