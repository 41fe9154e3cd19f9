// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/surface_map.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "dense_sampling.h"
#include "palpate/core/error.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Matrix3Xd;
using Eigen::Vector3d;
using Map = std::function<Vector3d(const Vector3d&)>;

Matrix3Xd images(const Matrix3Xd& points, const Map& map) {
  Matrix3Xd result(3, points.cols());
  for (Eigen::Index i = 0; i < points.cols(); ++i) result.col(i) = map(points.col(i));
  return result;
}

TriangleMesh deformed(const TriangleMesh& mesh, const Map& map) {
  return {.vertices = images(mesh.vertices, map), .triangles = mesh.triangles};
}

double hill(double x, double y) { return 4 * std::sin(0.1 * x) * std::cos(0.13 * y); }
TriangleMesh hills() { return test::height_field(20, 15, 4, hill); }
TriangleMesh sheet(int cols, int rows) {
  return test::height_field(cols, rows, 1, [](double, double) { return 0.0; });
}
/// A sheet of 80 mm x 60 mm of other triangles than `sheet`.
TriangleMesh sheet_of(int cols, int rows) {
  TriangleMesh mesh = sheet(cols, rows);
  mesh.vertices.row(0) *= 80.0 / cols;
  mesh.vertices.row(1) *= 60.0 / rows;
  return mesh;
}

/// Corners and middle, on a height field over 80 mm x 60 mm.
Matrix3Xd five_marks(double (*height)(double, double)) {
  Matrix3Xd marks(3, 5);
  marks << 0, 80, 80, 0, 40, 0, 0, 60, 60, 32, 0, 0, 0, 0, 0;
  for (auto mark : marks.colwise()) mark.z() = height(mark.x(), mark.y());
  return marks;
}
double flat(double, double) { return 0; }

Eigen::Isometry3d some_motion() {
  return Eigen::Translation3d(5, -7, 100) * Eigen::AngleAxisd(1.1, Vector3d(1, 2, 3).normalized());
}

test::Errors map_errors(const SurfaceMap& map, const TriangleMesh& source, const Map& truth) {
  return test::errors_of((map.positions - images(source.vertices, truth)).colwise().norm());
}

SurfaceMap map_by(const TriangleMesh& source, const TriangleMesh& target, const Matrix3Xd& marks,
                  const Map& truth) {
  return map_surface(source, target, {.source = marks, .target = images(marks, truth)});
}

TEST(MapSurface, IsExactForAMotionAScaleAndAnAffineMap) {
  const Eigen::Isometry3d motion = some_motion();
  const std::vector<Map> maps = {
      [&](const Vector3d& p) { return Vector3d(motion * p); },
      [&](const Vector3d& p) { return Vector3d(motion * (1.7 * p)); },
      [&](const Vector3d& p) {
        return Vector3d(motion * Vector3d(1.5 * p.x(), p.y(), 0.8 * p.z()));
      }};
  const std::vector<double> scales = {1, 1.7, 0};
  for (std::size_t i = 0; i < maps.size(); ++i) {
    Matrix3Xd marks = five_marks(hill);
    if (i < 2) marks = marks.leftCols(3).eval();
    const SurfaceMap map = map_by(hills(), deformed(hills(), maps[i]), marks, maps[i]);
    EXPECT_EQ(map.verdict, SurfaceMapVerdict::sensible) << map.reason;
    EXPECT_LT(map_errors(map, hills(), maps[i]).largest, 1e-9);
    EXPECT_LT(map.landmark_rms, 1e-9);
    EXPECT_NEAR(map.coverage, 1, 1e-9);
    if (i == 2) continue;
    EXPECT_NEAR(map.scale, scales[i], 1e-9);
    EXPECT_LT((map.area_distortion.array() - 1).abs().maxCoeff(), 1e-9);
    EXPECT_LT((map.angle_distortion.array() - 1).abs().maxCoeff(), 1e-9);
    for (const Eigen::Matrix3d& turn : local_rotations(hills(), map))
      EXPECT_LT((turn - motion.linear()).norm(), 1e-9);
  }
}

TEST(MapSurface, MeasuresTheStretchOfAnAffineMap) {
  const Map stretch = [](const Vector3d& p) { return Vector3d(2 * p.x(), p.y() / 2, 0); };
  const TriangleMesh source = sheet_of(10, 8);
  const SurfaceMap map =
      map_by(source, deformed(sheet_of(13, 9), stretch), five_marks(flat), stretch);
  EXPECT_LT(map_errors(map, source, stretch).largest, 1e-9);
  EXPECT_LT((map.singular_values.row(0).array() - 2).abs().maxCoeff(), 1e-9);
  EXPECT_LT((map.singular_values.row(1).array() - 0.5).abs().maxCoeff(), 1e-9);
  EXPECT_NEAR(map.angle_distortion[3], 4, 1e-9);
  EXPECT_EQ(map.distorted_share, 1);  // more than three
  EXPECT_EQ(map.folded_share, 0);
  EXPECT_EQ(map.verdict, SurfaceMapVerdict::not_sensible);
}

TEST(MapSurface, FollowsABendBetweenFewLandmarks) {
  constexpr double kRadius = 40;
  const Map bend = [](const Vector3d& p) {
    return Vector3d(kRadius * std::sin(p.x() / kRadius), p.y(),
                    kRadius * (1 - std::cos(p.x() / kRadius)));
  };
  const TriangleMesh source = sheet_of(20, 15);
  const SurfaceMap map = map_by(source, deformed(sheet_of(27, 22), bend), five_marks(flat), bend);
  EXPECT_EQ(map.verdict, SurfaceMapVerdict::sensible) << map.reason;
  const test::Errors off = map_errors(map, source, bend);
  EXPECT_LT(off.rms, 0.8);  // [mm] of 80 mm that bend by 2 radians
  EXPECT_LT(off.largest, 1.5);
  const std::vector<Eigen::Matrix3d> turns = local_rotations(source, map);
  for (Eigen::Index v = 0; v < source.vertices.cols(); ++v) {
    const Eigen::Matrix3d truth =
        Eigen::AngleAxisd(-source.vertices(0, v) / kRadius, Vector3d::UnitY()).toRotationMatrix();
    EXPECT_LT((turns[static_cast<std::size_t>(v)] - truth).norm(), 0.2);
  }
}

TEST(MapSurface, MapsASphereOntoAnEllipsoidOfOtherTriangles) {
  const Map ellipsoid = [](const Vector3d& p) { return Vector3d(1.4 * p.x(), p.y(), 0.8 * p.z()); };
  const TriangleMesh source = test::icosphere(3, 40);
  const TriangleMesh turned =
      test::moved(test::icosphere(4, 40),
                  Eigen::Isometry3d(Eigen::AngleAxisd(0.37, Vector3d(1, 1, 0).normalized())));
  Matrix3Xd marks(3, 5);
  marks << 40, 0, 0, -40, 0, 0, 40, 0, 0, 0, 0, 0, 40, 0, -40;
  const SurfaceMap map = map_by(source, deformed(turned, ellipsoid), marks, ellipsoid);
  EXPECT_EQ(map.verdict, SurfaceMapVerdict::sensible) << map.reason;
  EXPECT_LT(map_errors(map, source, ellipsoid).largest, 0.2);  // facets lie 0.1 mm below the sphere
}

TEST(MapSurface, SaysThatAMirroredSurfaceHasNoSensibleMap) {
  const Map mirrored = [](const Vector3d& p) {
    return Vector3d(80 - p.x(), p.y(), hill(80 - p.x(), p.y()));
  };
  const SurfaceMap map = map_by(hills(), hills(), five_marks(hill), mirrored);
  EXPECT_EQ(map.verdict, SurfaceMapVerdict::not_sensible);
  EXPECT_GT(map.folded_share, 0.9);
  EXPECT_NE(map.reason.find("folded"), std::string::npos);
}

std::string refused_map(const TriangleMesh& source, const TriangleMesh& target,
                        const Landmarks& landmarks, const SurfaceMapOptions& options = {}) {
  return refusal([&] { return map_surface(source, target, landmarks, options); });
}

void expect_says(const std::string& message, const std::string& part) {
  EXPECT_NE(message.find(part), std::string::npos) << message;
}

TEST(MapSurface, RefusesLandmarksThatDoNotFixIt) {
  const Matrix3Xd marks = five_marks(hill);
  const auto same = [](const Matrix3Xd& m) { return Landmarks{.source = m, .target = m}; };
  expect_says(refused_map(hills(), hills(), same(marks.leftCols(2))), "at least three");
  expect_says(refused_map(hills(), hills(), {.source = marks, .target = marks.leftCols(4)}),
              "5 landmarks of the source and 4");
  Matrix3Xd bad = marks;
  bad.col(3).z() += 10;
  expect_says(refused_map(hills(), hills(), {.source = marks, .target = bad}),
              "landmark 3 of the target is 9.99");
  bad.col(3).z() = std::numeric_limits<double>::quiet_NaN();
  expect_says(refused_map(hills(), hills(), {.source = bad, .target = marks}),
              "landmark 3 is not finite");
  Matrix3Xd line(3, 3);
  line << 0, 30, 80, 0, 0, 0, hill(0, 0), hill(30, 0), hill(80, 0);
  line.row(2).setZero();
  expect_says(refused_map(sheet_of(9, 9), sheet_of(9, 9), same(line)), "in a line");
}

TEST(MapSurface, RefusesOtherTopologyAndBadOptions) {
  const Matrix3Xd marks = five_marks(hill);
  const Landmarks landmarks{.source = marks, .target = marks};
  TriangleMesh holed = hills();
  holed.triangles =
      (Eigen::Matrix3Xi(3, holed.triangles.cols() - 1) << holed.triangles.leftCols(211),
       holed.triangles.rightCols(holed.triangles.cols() - 212))
          .finished();
  expect_says(refused_map(hills(), holed, landmarks), "border loops");
  expect_says(refused_map(hills(), test::icosphere(2, 30), landmarks), "border loops");
  SurfaceMapOptions options;
  options.max_bad_share = 2;
  expect_says(refused_map(hills(), hills(), landmarks, options), "max_bad_share");
  options = {.max_landmark_distance = std::numeric_limits<double>::quiet_NaN()};
  expect_says(refused_map(hills(), hills(), landmarks, options), "max_landmark_distance");
}

}  // namespace
}  // namespace palpate::geometry
