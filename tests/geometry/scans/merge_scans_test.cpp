// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/merge_scans.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "dense_sampling.h"
#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/geometry/mesh_defects.h"
#include "palpate/geometry/mesh_measures.h"
#include "palpate/geometry/range_map_mesh.h"
#include "palpate/geometry/surface_query.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

constexpr double kRayNoise = 0.1;  // [mm] standard deviation along the ray

/// View of a mesh about the origin from a camera at `eye`: one ray a pixel, neighbouring hits
/// connected unless there is a depth step, in a frame of its own.
Scan look_at(const TriangleMesh& object, const Vector3d& eye, double width, int pixels,
             unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> noise(0, kRayNoise);
  const SurfaceQuery query(object);
  const Vector3d forward = -eye.normalized();
  const Vector3d right = forward.unitOrthogonal();
  const Vector3d down = forward.cross(right);
  const double spacing = width / pixels;
  std::vector<Vector3d> points;
  std::map<std::pair<int, int>, int> index;
  for (int v = 0; v <= pixels; ++v) {
    for (int u = 0; u <= pixels; ++u) {
      const Vector3d pixel = (u * spacing - width / 2) * right + (v * spacing - width / 2) * down;
      const Ray ray{.origin = eye, .direction = pixel - eye};
      const auto hit = query.first_hit(ray);
      if (!hit) continue;
      index[{v, u}] = static_cast<int>(points.size());
      points.push_back(hit->position + noise(random) * ray.direction.normalized());
    }
  }
  std::vector<Eigen::Vector3i> triangles;
  const auto add = [&](std::pair<int, int> a, std::pair<int, int> b, std::pair<int, int> c) {
    if (!index.contains(a) || !index.contains(b) || !index.contains(c)) return;
    const Eigen::Vector3i t(index[a], index[b], index[c]);
    for (int k = 0; k < 3; ++k) {
      const Vector3d edge =
          points[static_cast<size_t>(t[k])] - points[static_cast<size_t>(t[(k + 1) % 3])];
      if (edge.norm() > 4 * spacing) return;
    }
    triangles.push_back(t);
  };
  for (int v = 0; v < pixels; ++v) {
    for (int u = 0; u < pixels; ++u) {
      add({v, u}, {v + 1, u}, {v + 1, u + 1});
      add({v, u}, {v + 1, u + 1}, {v, u + 1});
    }
  }
  Scan scan;
  scan.T_object_scan = Eigen::Translation3d(3.3, -7.7, 11.1) *
                       Eigen::AngleAxisd(0.3 * seed, Vector3d(1, 2, 3).normalized());
  scan.mesh.vertices.resize(3, static_cast<Eigen::Index>(points.size()));
  for (size_t i = 0; i < points.size(); ++i) {
    scan.mesh.vertices.col(static_cast<Eigen::Index>(i)) = scan.T_object_scan.inverse() * points[i];
  }
  scan.mesh.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  for (size_t i = 0; i < triangles.size(); ++i) {
    scan.mesh.triangles.col(static_cast<Eigen::Index>(i)) = triangles[i];
  }
  return scan;
}

/// Number of triangles of each undirected edge.
std::map<std::pair<int, int>, int> edge_use(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> use;
  for (const auto& t : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) ++use[std::minmax(t[k], t[(k + 1) % 3])];
  }
  return use;
}

int open_edges(const TriangleMesh& mesh) {
  int border = 0;
  for (const auto& [edge, count] : edge_use(mesh)) {
    EXPECT_LE(count, 2) << "edge " << edge.first << " " << edge.second << " is not manifold";
    border += count == 1;
  }
  return border;
}

int components(const TriangleMesh& mesh) {
  std::vector<int> parent(static_cast<size_t>(mesh.vertices.cols()));
  for (size_t i = 0; i < parent.size(); ++i) parent[i] = static_cast<int>(i);
  const auto root = [&](int v) {
    while (parent[static_cast<size_t>(v)] != v) v = parent[static_cast<size_t>(v)];
    return v;
  };
  for (const auto& [edge, count] : edge_use(mesh)) {
    parent[static_cast<size_t>(root(edge.first))] = root(edge.second);
  }
  int roots = 0;
  for (size_t i = 0; i < parent.size(); ++i) roots += parent[i] == static_cast<int>(i);
  return roots;
}

test::Errors distances_to(const TriangleMesh& truth, const Eigen::Matrix3Xd& points) {
  return test::errors_of(closest_points(SurfaceQuery(truth), points).distances);
}

TEST(MergeScans, OfASphereFromAllSidesAreTheSphere) {
  const TriangleMesh sphere = test::icosphere(5, 30);
  std::vector<Scan> scans;
  unsigned seed = 1;
  for (const Vector3d& eye : {Vector3d(200, 1, 2), Vector3d(-200, 3, 1), Vector3d(1, 200, 2),
                              Vector3d(2, -200, 1), Vector3d(3, 1, 200), Vector3d(1, 2, -200)}) {
    scans.push_back(look_at(sphere, eye, 80, 26, seed++));
  }
  const MergedScans merged = merge_scans(scans);
  EXPECT_EQ(open_edges(merged.mesh), 0);
  EXPECT_EQ(components(merged.mesh), 1);
  EXPECT_GT(merged.spacing, 80.0 / 26);
  EXPECT_LT(merged.spacing, 2 * 80.0 / 26);
  const test::Errors there = distances_to(sphere, merged.mesh.vertices);
  const test::Errors back = distances_to(merged.mesh, sphere.vertices);
  EXPECT_LT(there.rms, 0.1 * merged.spacing);
  EXPECT_LT(back.rms, 0.1 * merged.spacing);
  EXPECT_LT(std::max(there.largest, back.largest), merged.spacing);
  // Counter-clockwise seen from outside: the signed volume is that of the ball.
  double volume = 0;
  for (const auto& t : merged.mesh.triangles.colwise()) {
    volume += merged.mesh.vertices.col(t[0]).dot(
                  merged.mesh.vertices.col(t[1]).cross(merged.mesh.vertices.col(t[2]))) /
              6;
  }
  EXPECT_NEAR(volume, 4.0 / 3 * std::numbers::pi * 27000,
              0.03 * 4.0 / 3 * std::numbers::pi * 27000);
}

/// The vertices at the border, 3 x N.
Eigen::Matrix3Xd border_of(const TriangleMesh& mesh) {
  std::vector<int> border;
  for (const auto& [edge, count] : edge_use(mesh)) {
    if (count == 1) border.push_back(edge.first);
  }
  return mesh.vertices(Eigen::all, border);
}

double largest_distance_between(const Eigen::Matrix3Xd& points, const Eigen::Matrix3Xd& others) {
  double largest = 0;
  for (const auto& p : points.colwise())
    largest =
        std::max(largest, std::sqrt((others.colwise() - p).colwise().squaredNorm().minCoeff()));
  return largest;
}

/// Checks that the surface is there wherever a scan measured, and nowhere else.
void expect_covers_scans(const MergedScans& merged, const std::vector<Scan>& scans) {
  Eigen::VectorXd nearest = Eigen::VectorXd::Constant(merged.mesh.vertices.cols(), kInf);
  for (const Scan& scan : scans) {
    const TriangleMesh placed{.vertices = scan.T_object_scan * scan.mesh.vertices,
                              .triangles = scan.mesh.triangles};
    const test::Errors missing = distances_to(merged.mesh, placed.vertices);
    EXPECT_LT(missing.rms, 0.4 * merged.spacing);
    EXPECT_LT(missing.largest, 2.5 * merged.spacing);  // spikes of one triangle at silhouettes
    nearest =
        nearest.cwiseMin(closest_points(SurfaceQuery(placed), merged.mesh.vertices).distances);
  }
  EXPECT_LT(nearest.maxCoeff(), merged.spacing);
}

TEST(MergeScans, OfAHalfSeenSphereStayOpenWhereNobodyLooked) {
  const TriangleMesh sphere = test::icosphere(5, 30);
  const std::vector<Scan> scans = {look_at(sphere, {140, 1, 142}, 80, 26, 1),
                                   look_at(sphere, {-141, 3, 140}, 80, 26, 2)};
  const MergedScans merged = merge_scans(scans);
  EXPECT_EQ(components(merged.mesh), 1);
  expect_covers_scans(merged, scans);
  EXPECT_LT(distances_to(sphere, merged.mesh.vertices).rms, 0.2 * merged.spacing);
  // Its border is made of those of the scans: none is at the seam.
  Eigen::Matrix3Xd borders(3, 0);
  for (const Scan& scan : scans) {
    const Eigen::Matrix3Xd border = scan.T_object_scan * border_of(scan.mesh);
    borders.conservativeResize(3, borders.cols() + border.cols());
    borders.rightCols(border.cols()) = border;
  }
  const Eigen::Matrix3Xd border = border_of(merged.mesh);
  ASSERT_GT(border.cols(), 0);
  EXPECT_LT(largest_distance_between(border, borders), 2 * merged.spacing);
}

TEST(MergeScans, OfAGloveFromSixSidesAreWhatTheySee) {
  TriangleMesh glove = test::glove(2.1);
  glove.vertices.colwise() += Vector3d(0, -55, 0);
  std::vector<Scan> scans;
  unsigned seed = 1;
  for (const Vector3d& eye :
       {Vector3d(20, 30, 600), Vector3d(-20, 30, -600), Vector3d(500, 10, 350),
        Vector3d(-500, 10, -350), Vector3d(-480, 20, 360), Vector3d(480, 20, -360)}) {
    scans.push_back(look_at(glove, eye, 190, 80, seed++));
  }
  const MergedScans merged = merge_scans(scans);
  EXPECT_TRUE(find_defects(merged.mesh).empty());
  EXPECT_EQ(components(merged.mesh), 1);
  EXPECT_TRUE(merged.conflicts.empty());
  expect_covers_scans(merged, scans);
  const test::Errors there = distances_to(glove, merged.mesh.vertices);
  EXPECT_LT(there.rms, 0.2 * merged.spacing);
  EXPECT_LT(there.largest, 2 * merged.spacing);
}

TEST(MergeScans, OfFlatSheetsAreFlat) {
  for (const int cells : {1, 3, 20}) {
    const TriangleMesh sheet = test::flat_sheet(cells, cells, 1.5);
    const std::vector<Scan> scans = {{.mesh = sheet}};
    const MergedScans merged = merge_scans(scans);
    EXPECT_TRUE((merged.mesh.vertices.row(2).array() == 0).all()) << cells;
    // The border is right within half a spacing on each side.
    EXPECT_NEAR(std::sqrt(surface_area(merged.mesh)), 1.5 * cells, merged.spacing) << cells;
  }
}

TEST(MergeScans, OfAOneSidedSurfaceAreRefused) {
  // A Moebius band: the last square is joined to the first one upside down.
  constexpr int kAround = 24;
  TriangleMesh band{.vertices = Eigen::Matrix3Xd(3, 2 * kAround),
                    .triangles = Eigen::Matrix3Xi(3, 2 * kAround)};
  for (int i = 0; i < kAround; ++i) {
    const double angle = 2 * std::numbers::pi * i / kAround;
    const Vector3d out(std::cos(angle), std::sin(angle), 0);
    const Vector3d across = std::cos(angle / 2) * out + std::sin(angle / 2) * Vector3d::UnitZ();
    band.vertices.col(2 * i) = 20 * out - 5 * across;
    band.vertices.col(2 * i + 1) = 20 * out + 5 * across;
    const bool last = i + 1 == kAround;
    const int low = last ? 1 : 2 * i + 2, high = last ? 0 : 2 * i + 3;
    band.triangles.col(2 * i) << 2 * i, low, high;
    band.triangles.col(2 * i + 1) << 2 * i, high, 2 * i + 1;
  }
  std::vector<Scan> scans = {{.mesh = test::icosphere(2, 20)}, {.mesh = band}};
  EXPECT_THAT(
      [&] { (void)merge_scans(scans); },
      ::testing::ThrowsMessage<InvalidInput>(::testing::AllOf(
          ::testing::HasSubstr("scan 1 is not manifold"), ::testing::HasSubstr("repair_mesh"))));
  scans[1].name = "left.ply";
  EXPECT_THAT(
      [&] { (void)merge_scans(scans); },
      ::testing::ThrowsMessage<InvalidInput>(::testing::StartsWith("left.ply is not manifold; ")));
}

TEST(MergeScans, AverageByTheirStandardDeviations) {
  // Two sheets half a millimetre apart, one of them measured twice as well as the other.
  TriangleMesh low = test::flat_sheet(20, 20, 2), high = low;
  high.vertices.row(2).array() += 0.5;
  const Eigen::Index count = low.vertices.cols();
  const std::vector<Scan> scans = {{.mesh = low, .sigma = Eigen::VectorXd::Constant(count, 0.1)},
                                   {.mesh = high, .sigma = Eigen::VectorXd::Constant(count, 0.2)}};
  const MergedScans merged = merge_scans(scans);
  const double mean = 0.5 * 0.01 / (0.01 + 0.04);
  for (Eigen::Index v = 0; v < merged.mesh.vertices.cols(); ++v) {
    EXPECT_NEAR(merged.mesh.vertices(2, v), mean, 0.1 * mean);
    EXPECT_NEAR(merged.sigma[v], 1 / std::sqrt(1 / 0.01 + 1 / 0.04), 1e-7);  // summed as floats
  }
  // If one of the scans has no deviations, none can be weighted.
  const std::vector<Scan> half_known = {scans[0], {.mesh = high}};
  const MergedScans equal = merge_scans(half_known);
  EXPECT_EQ(equal.sigma.size(), 0);
  EXPECT_NEAR(equal.mesh.vertices.row(2).mean(), 0.25, 0.01);
}

TEST(MergeScans, HaveLessNoiseTheMoreThereAre) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.1);
  std::vector<Scan> scans;
  std::vector<double> rms;
  for (int i = 0; i < 16; ++i) {
    scans.push_back({.mesh = test::flat_sheet(30, 30, 1)});
    for (double& z : scans.back().mesh.vertices.row(2)) z = noise(random);
    if (i == 0 || i == 15) {
      const MergedScans merged = merge_scans(scans);
      rms.push_back(test::errors_of(merged.mesh.vertices.row(2).transpose().cwiseAbs()).rms);
    }
  }
  EXPECT_NEAR(rms[0] / rms[1], 4, 0.5);
}

TEST(MergeScans, KeepBothSidesOfAWall) {
  // Sheets that face away from each other, 2.5 spacings apart.
  TriangleMesh front = test::flat_sheet(20, 20, 1), back = front;
  back.vertices.row(2).array() -= 2.5;
  back.triangles.row(1).swap(back.triangles.row(2));
  const std::vector<Scan> scans = {{.mesh = front}, {.mesh = back}};
  const MergedScans merged = merge_scans(scans, {.spacing = 1});
  EXPECT_EQ(components(merged.mesh), 2);
  for (const double z : merged.mesh.vertices.row(2))
    EXPECT_LT(std::min(std::abs(z), std::abs(z + 2.5)), 0.15);
  EXPECT_NEAR(surface_area(merged.mesh), 2 * 400, 2 * 42);
}

TEST(MergeScans, DoNotDependOnTheirOrder) {
  const TriangleMesh sphere = test::icosphere(4, 30);
  std::vector<Scan> scans;
  unsigned seed = 1;
  for (const Vector3d& eye : {Vector3d(200, 1, 2), Vector3d(100, 170, 1), Vector3d(90, 1, 180)})
    scans.push_back(look_at(sphere, eye, 80, 20, seed++));
  const TriangleMesh there = merge_scans(scans).mesh;
  std::swap(scans[0], scans[2]);
  const TriangleMesh back = merge_scans(scans).mesh;
  ASSERT_EQ(there.vertices.cols(), back.vertices.cols());
  EXPECT_TRUE(there.triangles == back.triangles);
  EXPECT_LT((there.vertices - back.vertices).cwiseAbs().maxCoeff(), 1e-5);  // summed as floats
}

TEST(MergeScans, TellTheirProgressAndEndWhenTold) {
  const std::vector<Scan> scans(3, Scan{.mesh = test::flat_sheet(30, 30, 1)});
  std::vector<int> done;
  MergeScansOptions options{.progress = [&](int scan, int total) {
    EXPECT_EQ(total, 3);
    done.push_back(scan);
  }};
  (void)merge_scans(scans, options);
  EXPECT_TRUE(std::ranges::is_sorted(done));
  for (const int scan : {0, 1, 2}) EXPECT_GT(std::ranges::count(done, scan), 1) << scan;
  EXPECT_EQ(std::ranges::count(done, 3), 1);
  struct Stopped {};
  options.progress = [](int scan, int) {
    EXPECT_EQ(scan, 0);
    throw Stopped();
  };
  EXPECT_THROW((void)merge_scans(scans, options), Stopped);
}

TEST(MergeScans, RefuseAGridThatDoesNotFitIntoMemory) {
  const std::vector<Scan> scans = {{.mesh = test::icosphere(3, 1000)}};
  EXPECT_THAT([&] { (void)merge_scans(scans, {.spacing = 0.5}); },
              ::testing::ThrowsMessage<InvalidInput>(
                  ::testing::AllOf(::testing::HasSubstr("GB"), ::testing::HasSubstr("spacing"))));
  EXPECT_THAT([&] { (void)merge_scans(scans, {.spacing = 1e-4, .max_memory = kInf}); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("too many points")));
  const std::vector<Scan> huge = {{.mesh = test::icosphere(3, 1e100)}};
  EXPECT_THAT([&] { (void)merge_scans(huge, {.spacing = 1e80}); },
              ::testing::ThrowsMessage<InvalidInput>(::testing::HasSubstr("a grid of 1e+80 mm")));
}

constexpr double kBall = 18;     // [mm] radius of a ball about the origin
constexpr double kPixel = 0.63;  // [mm] at its distance

/// View of the ball by a depth camera at 400 mm, with normal noise [mm] along the axis.
Scan look_at_ball(const Vector3d& from, double noise, unsigned seed,
                  const Vector3d& centre = Vector3d::Zero()) {
  constexpr double kDistance = 400;
  constexpr int kPixels = 66;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  RangeMap map{.z = ImageF::Constant(kPixels, kPixels, kFloatNaN), .camera = {}};
  map.camera.width = map.camera.height = kPixels;
  map.camera.fx = map.camera.fy = kDistance / kPixel;
  map.camera.cx = map.camera.cy = (kPixels - 1) / 2.0;
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), -from.normalized());
  const Eigen::Isometry3d T = Eigen::Translation3d(kDistance * from.normalized()) * turn;
  const Vector3d ball = T.inverse() * centre;
  const Eigen::Matrix2Xd rays = pixel_rays(map.camera);
  for (int pixel = 0; pixel < rays.cols(); ++pixel) {
    const Vector3d ray = rays.col(pixel).homogeneous().normalized();
    const double along = ray.dot(ball);
    const double inside = kBall * kBall - ball.squaredNorm() + along * along;
    if (inside <= 0) continue;
    const double z = (along - std::sqrt(inside)) * ray.z() + noise * normal(random);
    map.z(pixel / kPixels, pixel % kPixels) = static_cast<float>(z);
  }
  return {.mesh = mesh_range_map(map).mesh, .T_object_scan = T, .viewpoint = Vector3d::Zero()};
}

TEST(MergeScans, AreTheSameOnAnyNumberOfThreads) {
  std::vector<Scan> scans;
  for (unsigned i = 0; i < 9; ++i)
    scans.push_back(look_at_ball({std::cos(0.7 * i), std::sin(0.7 * i), 0.5}, 0.5, i + 1));
  const TriangleMesh many = merge_scans(scans, {.spacing = 1}).mesh;
  const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
  const TriangleMesh single = merge_scans(scans, {.spacing = 1}).mesh;
  EXPECT_TRUE(many.vertices == single.vertices);
  EXPECT_TRUE(many.triangles == single.triangles);
}

TEST(MergeScans, LeaveNoSheetsWhereTheNoiseIsMoreThanAPixel) {
  std::vector<Scan> scans;
  for (unsigned i = 0; i < 8; ++i) {
    const double angle = i * std::numbers::pi / 4, up = i % 2 == 0 ? 1.4 : 0.5;
    scans.push_back(look_at_ball({std::cos(angle), std::sin(angle), up}, 1.0, i + 1));
  }
  for (const auto& [spacing, largest_rms] : {std::pair(1.0, 0.31), {2.0, 0.44}}) {
    const MergedScans merged = merge_scans(scans, {.spacing = spacing});
    const Eigen::VectorXd errors =
        (merged.mesh.vertices.colwise().norm().array() - kBall).abs().transpose();
    EXPECT_LT(test::errors_of(errors).rms, largest_rms) << spacing;
    EXPECT_GT(surface_area(merged.mesh), 2 * std::numbers::pi * kBall * kBall);
    EXPECT_TRUE(merged.conflicts.empty());
  }
}

TEST(MergeScans, OfAnObjectThatMovedAreInConflict) {
  const Vector3d view = Vector3d(1, 0, 0.4).normalized();
  const Scan still = look_at_ball(view, 0.3, 1);
  const auto conflicts = [&](const Scan& other, bool know_viewpoint) {
    std::vector<Scan> scans = {still, other};
    if (!know_viewpoint) scans[0].viewpoint = scans[1].viewpoint = std::nullopt;
    return merge_scans(scans, {.spacing = 1.5, .reach = 2}).conflicts;
  };
  EXPECT_TRUE(conflicts(look_at_ball(view, 0.3, 2), true).empty());
  // 5 mm towards the camera, beyond the reach: the first scan lies behind it.
  for (const bool know_viewpoint : {true, false}) {
    const std::vector<ScanConflict> found =
        conflicts(look_at_ball(view, 0.3, 2, 5 * view), know_viewpoint);
    ASSERT_EQ(found.size(), 1U) << know_viewpoint;
    EXPECT_EQ(found[0].scan, 0);
    EXPECT_EQ(found[0].other, 1);
    EXPECT_GT(found[0].share, 0.5);
    EXPECT_NEAR(found[0].depth, 4.5, 1);
  }
  // Another scene, far in front: only with the viewpoint is it known to be in the way.
  const Scan far = look_at_ball(view, 0.3, 2, 60 * view);
  EXPECT_EQ(conflicts(far, true).size(), 1U);
  EXPECT_TRUE(conflicts(far, false).empty());
}

TEST(MergeScans, OfOppositeSidesAreInNoConflict) {
  const std::vector<Scan> scans = {look_at_ball({1, 0, 0}, 0.3, 1),
                                   look_at_ball({-1, 0, 0}, 0.3, 2),
                                   look_at_ball({0, 1, 0.2}, 0.3, 3)};
  EXPECT_TRUE(merge_scans(scans, {.spacing = 1.5}).conflicts.empty());
}

TEST(MergeScans, RefuseASpacingBeyondTheirSize) {
  const std::vector<Scan> scans = {{.mesh = test::icosphere(3, 30)}};
  for (const double spacing : {104.0, 1e18, 1e99}) {
    EXPECT_THAT([&] { (void)merge_scans(scans, {.spacing = spacing}); },
                ::testing::ThrowsMessage<InvalidInput>(
                    ::testing::AllOf(::testing::HasSubstr("MergeScansOptions::spacing is"),
                                     ::testing::HasSubstr("at most the size of the scans, 103.9"))))
        << spacing;
  }
}

TEST(MergeScans, RefusesWhatIsNoScan) {
  EXPECT_THROW((void)merge_scans({}), InvalidInput);
  std::vector<Scan> scans(2, {.mesh = test::icosphere(1, 30)});
  EXPECT_THROW((void)merge_scans(scans, {.reach = 1.9}), InvalidInput);
  EXPECT_THROW((void)merge_scans(scans, {.spacing = 0}), InvalidInput);
  EXPECT_THROW((void)merge_scans(scans, {.max_memory = 0}), InvalidInput);
  scans[1].sigma = Eigen::VectorXd::Ones(3);
  EXPECT_THROW((void)merge_scans(scans), InvalidInput);
  scans[1].sigma = Eigen::VectorXd::Constant(scans[1].mesh.vertices.cols(), kNaN);
  EXPECT_THROW((void)merge_scans(scans), InvalidInput);
  scans[1].sigma = {};
  scans[1].T_object_scan.translation().x() = kInf;
  EXPECT_THROW((void)merge_scans(scans), InvalidInput);
  scans[1].T_object_scan = Eigen::Isometry3d::Identity();
  scans[1].T_object_scan.linear() *= 2;
  EXPECT_THROW((void)merge_scans(scans), InvalidInput);
  scans[1].T_object_scan.linear() = Vector3d(1, 1, -1).asDiagonal();
  EXPECT_THROW((void)merge_scans(scans), InvalidInput);
  scans[1] = {.mesh = {}};
  try {
    (void)merge_scans(scans);
    FAIL();
  } catch (const InvalidInput& error) {
    EXPECT_NE(std::string(error.what()).find("scan 1"), std::string::npos);
  }
  TriangleMesh point = test::icosphere(1, 0);
  scans = {{.mesh = point}};
  EXPECT_THROW((void)merge_scans(scans), InvalidInput);
}

}  // namespace
}  // namespace palpate::geometry
