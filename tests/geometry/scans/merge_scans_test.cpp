// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/merge_scans.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "cgal_availability.h"
#include "dense_sampling.h"
#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/error.h"
#include "palpate/geometry/surface_query.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

constexpr double kRayNoise = 0.1;  // [mm] standard deviation along the ray

/// What a camera at `eye` sees of a mesh about the origin: one ray a pixel, neighbouring hits
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

/// How many triangles each undirected edge has.
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
  if (!test::has_cgal()) GTEST_SKIP() << "the library was built without CGAL";
  const TriangleMesh sphere = test::icosphere(5, 30);
  std::vector<Scan> scans;
  unsigned seed = 1;
  for (const Vector3d& eye : {Vector3d(200, 1, 2), Vector3d(-200, 3, 1), Vector3d(1, 200, 2),
                              Vector3d(2, -200, 1), Vector3d(3, 1, 200), Vector3d(1, 2, -200)}) {
    scans.push_back(look_at(sphere, eye, 80, 26, seed++));
  }
  const MergedScans merged = merge_scans(scans);
  EXPECT_THROW((void)merge_scans(scans, {.reach = 1e-9}), SolverError);
  EXPECT_EQ(merged.trimmed, 0);
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

TEST(MergeScans, OfAHalfSeenSphereStayOpenWhereNobodyLooked) {
  if (!test::has_cgal()) GTEST_SKIP() << "the library was built without CGAL";
  const TriangleMesh sphere = test::icosphere(5, 30);
  const Vector3d left(140, 1, 142), right(-141, 3, 140);
  const std::vector<Scan> scans = {look_at(sphere, left, 80, 26, 1),
                                   look_at(sphere, right, 80, 26, 2)};
  const MergedScans merged = merge_scans(scans);
  EXPECT_GT(merged.trimmed, 0);
  EXPECT_EQ(components(merged.mesh), 1);
  EXPECT_GT(open_edges(merged.mesh), 0);
  // A camera 200 mm away sees a place of a 30 mm ball iff the cosine towards it is at least 0.15; a
  // pixel at the rim is up to 0.3 wide in it. So no border is where a camera looks, nor at the
  // seam.
  const auto cosine = [&](const Vector3d& p) {
    return std::max(p.normalized().dot(left.normalized()), p.normalized().dot(right.normalized()));
  };
  for (const auto& [edge, count] : edge_use(merged.mesh)) {
    if (count == 1) {
      EXPECT_LT(cosine(merged.mesh.vertices.col(edge.first)), 0.15 + 0.3);
    }
  }
  Eigen::Matrix3Xd seen(3, sphere.vertices.cols());
  Eigen::Index count = 0;
  for (const auto& v : sphere.vertices.colwise()) {
    if (cosine(v) > 0.15 + 0.3) seen.col(count++) = v;
  }
  EXPECT_LT(distances_to(merged.mesh, seen.leftCols(count)).largest, merged.spacing);
  const MergedScans closed = merge_scans(scans, {.reach = kInf});
  EXPECT_EQ(open_edges(closed.mesh), 0);
  EXPECT_EQ(closed.trimmed, 0);
}

TEST(MergeScans, OfAGloveFromSixSidesAreTheGlove) {
  if (!test::has_cgal()) GTEST_SKIP() << "the library was built without CGAL";
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
  EXPECT_EQ(open_edges(merged.mesh), 0);
  EXPECT_EQ(components(merged.mesh), 1);
  const test::Errors there = distances_to(glove, merged.mesh.vertices);
  EXPECT_LT(there.rms, 0.2 * merged.spacing);
  EXPECT_LT(there.largest, 2 * merged.spacing);
  EXPECT_LT(distances_to(merged.mesh, glove.vertices).rms, 0.2 * merged.spacing);
}

TEST(MergeScans, RefusesWhatIsNoScan) {
  EXPECT_THROW((void)merge_scans({}), InvalidInput);
  std::vector<Scan> scans(2, {.mesh = test::icosphere(1, 30)});
  EXPECT_THROW((void)merge_scans(scans, {.reach = 0}), InvalidInput);
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
