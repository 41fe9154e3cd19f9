// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/geodesic_path.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <optional>
#include <queue>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "geodesic/geodesic_testing.h"
#include "mesh_corpus.h"
#include "not_finite.h"
#include "palpate/core/error.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/geometry/mesh_topology.h"
#include "refusal.h"
#include "test_surfaces.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

/// Accuracy that the header guarantees; relative to the distance and the mean length of the edges.
constexpr double kPathAccuracy = 1e-9;

/// [rad] of angles of short lines between points that are rounded.
constexpr double kAngleAccuracy = 1e-6;

std::optional<GeodesicPath> one_path(const TriangleMesh& mesh, const SurfacePoint& from,
                                     const SurfacePoint& to) {
  return shortest_paths(mesh, std::vector{from}, std::vector{to}).front();
}

double polyline_length(const TriangleMesh& mesh, const GeodesicPath& path) {
  double length = 0;
  for (size_t i = 1; i < path.points.size(); ++i)
    length += (position(mesh, path.points[i]) - position(mesh, path.points[i - 1])).norm();
  return length;
}

double angle(const Vector3d& a, const Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b));
}

/// The corner of a triangle at which a place is, if it is at a vertex.
std::optional<int> corner_at(const SurfacePoint& point) {
  Eigen::Index k = 0;
  if (point.barycentric.maxCoeff(&k) < 1) return std::nullopt;
  return static_cast<int>(k);
}

/// The smaller of the angles of the surface on both sides of a path at a vertex; only that of the
/// side of the surface on the border.
double least_side(const TriangleMesh& mesh, const Eigen::Matrix3Xi& opposite, int vertex,
                  const Vector3d& before, int triangle_before, const Vector3d& after,
                  int triangle_after) {
  const Vector3d at = mesh.vertices.col(vertex);
  const auto corner = [&](int t) {
    for (int k = 0; k < 3; ++k)
      if (mesh.triangles(k, t) == vertex) return k;
    throw std::logic_error("the triangle of a point does not have the point before it");
  };
  const auto edge = [&](int t, int k) -> Vector3d {
    return mesh.vertices.col(mesh.triangles((corner(t) + k) % 3, t)) - at;
  };
  const auto turn = [&](bool left) -> std::optional<double> {
    int t = triangle_before;
    double sum = angle(before - at, edge(t, left ? 2 : 1));
    for (int i = 0; i <= mesh.triangles.cols(); ++i) {
      const int across = opposite(left ? (corner(t) + 2) % 3 : corner(t), t);
      if (across < 0) return std::nullopt;
      t = across / 3;
      if (t == triangle_after) return sum + angle(edge(t, left ? 1 : 2), after - at);
      sum += angle(edge(t, 1), edge(t, 2));
    }
    return std::nullopt;
  };
  if (triangle_before == triangle_after) return angle(before - at, after - at);
  return std::min(turn(true).value_or(kInf), turn(false).value_or(kInf));
}

/// [rad] Deviation of a path from a straight one: on edges the turn of the unfolded path; at
/// vertices the angle by which the smaller side is less than straight.
double largest_turn(const TriangleMesh& mesh, const GeodesicPath& path) {
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  double largest = 0;
  for (size_t i = 1; i + 1 < path.points.size(); ++i) {
    const SurfacePoint& point = path.points[i];
    const Vector3d before = position(mesh, path.points[i - 1]);
    const Vector3d at = position(mesh, point);
    const Vector3d after = position(mesh, path.points[i + 1]);
    double lacking = 0;
    if (const auto k = corner_at(point)) {
      const int vertex = mesh.triangles(*k, point.triangle);
      lacking = std::numbers::pi - least_side(mesh, opposite, vertex, before, point.triangle, after,
                                              path.points[i + 1].triangle);
    } else {
      Eigen::Index off = 0;
      EXPECT_EQ(point.barycentric.minCoeff(&off), 0);
      const auto end = [&](Eigen::Index j) -> Vector3d {
        return mesh.vertices.col(mesh.triangles((off + j) % 3, point.triangle));
      };
      const Vector3d edge = end(2) - end(1);
      // Close to a vertex the points are rounded too much to tell.
      if (std::min((at - end(1)).norm(), (at - end(2)).norm()) < 1e-6 * edge.norm()) continue;
      lacking = std::abs(angle(before - at, edge) + angle(edge, after - at) - std::numbers::pi);
    }
    const double shortest = std::min((before - at).norm(), (after - at).norm());
    if (shortest > 1e-6 * path.length) largest = std::max(largest, lacking);
  }
  return largest;
}

double mean_edge(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles.colwise())
    for (int k = 0; k < 3; ++k)
      sum += (mesh.vertices.col(t[k]) - mesh.vertices.col(t[(k + 1) % 3])).norm();
  return sum / static_cast<double>(mesh.triangles.size());
}

std::vector<TriangleMesh> surfaces() {
  return {test::bumpy(1500, 2.0),       test::bumpy(2000, 20),  test::glove(9.0),
          test::closed_sheet(30, 20),   test::icosphere(3, 10), test::torus(24, 12, 20, 8),
          test::flat_sheet(20, 15, 1.3)};
}

/// Places in triangles, on edges and at vertices.
std::vector<SurfacePoint> any_places(const TriangleMesh& mesh, int count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_int_distribution<int> any(0, static_cast<int>(mesh.triangles.cols()) - 1);
  std::vector<SurfacePoint> places;
  for (int i = 0; i < count; ++i) {
    const Vector3d weights = i % 3 == 0   ? Vector3d(0, 1, 0)
                             : i % 3 == 1 ? Vector3d(0.2, 0.3, 0.5)
                                          : Vector3d(0.7, 0, 0.3);
    places.push_back({any(random), weights});
  }
  return places;
}

TEST(ShortestPaths, AreAsLongAsTheExactDistanceAndStraight) {
  for (const TriangleMesh& mesh : surfaces()) {
    const double edge = mean_edge(mesh);
    const std::vector<SurfacePoint> sources = any_places(mesh, 3, 7);
    const std::vector<SurfacePoint> vertices = vertex_points(mesh);
    std::vector<SurfacePoint> targets;
    std::vector<size_t> ids;
    for (size_t v = 0; v < vertices.size(); v += 7) {
      if (vertices[v].triangle < 0) continue;
      targets.push_back(vertices[v]);
      ids.push_back(v);
    }
    for (const SurfacePoint& source : sources) {
      const GeodesicDistance truth =
          geodesic_distance(mesh, std::vector{source}, {.method = GeodesicMethod::exact});
      const auto paths = shortest_paths(mesh, std::vector{source}, targets);
      ASSERT_EQ(paths.size(), targets.size());
      for (size_t i = 0; i < paths.size(); ++i) {
        const double distance = truth.distance[static_cast<Eigen::Index>(ids[i])];
        ASSERT_EQ(paths[i].has_value(), distance < kInf);
        if (!paths[i]) continue;
        const double error = kPathAccuracy * (distance + edge);
        EXPECT_NEAR(paths[i]->length, distance, error);
        EXPECT_NEAR(polyline_length(mesh, *paths[i]), distance, error);
        EXPECT_LT(largest_turn(mesh, *paths[i]), kAngleAccuracy);
        EXPECT_LT((position(mesh, paths[i]->points.front()) - position(mesh, source)).norm(),
                  error);
        EXPECT_LT((position(mesh, paths[i]->points.back()) - position(mesh, targets[i])).norm(),
                  error);
      }
    }
  }
}

TEST(ShortestPaths, AreTheSameBackwards) {
  for (const TriangleMesh& mesh : surfaces()) {
    const std::vector<SurfacePoint> places = any_places(mesh, 6, 11);
    for (size_t i = 0; i < places.size(); ++i) {
      const auto there = shortest_paths(mesh, std::vector{places[i]}, places);
      for (size_t j = 0; j < i; ++j) {
        const auto back = one_path(mesh, places[j], places[i]);
        ASSERT_EQ(there[j].has_value(), back.has_value());
        if (!back) continue;
        EXPECT_NEAR(there[j]->length, back->length,
                    kPathAccuracy * (back->length + mean_edge(mesh)));
      }
    }
  }
}

/// Expects a path to be the straight line between two places of a flat mesh.
void expect_straight_line(const TriangleMesh& flat, const GeodesicPath& path,
                          const SurfacePoint& from, const SurfacePoint& to) {
  const Vector3d start = position(flat, from);
  const Vector3d way = position(flat, to) - start;
  EXPECT_NEAR(path.length, way.norm(), kPathAccuracy * (1 + way.norm()));
  double last = 0;
  for (const SurfacePoint& point : path.points) {
    const Vector3d at = position(flat, point) - start;
    EXPECT_LT(at.cross(way).norm(), kPathAccuracy * (1 + way.squaredNorm()));
    EXPECT_GE(at.dot(way), last - kPathAccuracy);  // no way back
    last = at.dot(way);
  }
}

TEST(ShortestPaths, OnAFlatSheetAreTheStraightLine) {
  for (const double shear : {0.0, 2.0, 13.0}) {
    TriangleMesh sheet = test::flat_sheet(29, 19, 1.3);
    sheet.vertices.row(0) += shear * sheet.vertices.row(1);
    const std::vector<SurfacePoint> targets = any_places(sheet, 12, 4);
    for (const SurfacePoint& from : any_places(sheet, 6, 3)) {
      const auto paths = shortest_paths(sheet, std::vector{from}, targets);
      for (size_t i = 0; i < targets.size(); ++i) {
        ASSERT_TRUE(paths[i]);
        expect_straight_line(sheet, *paths[i], from, targets[i]);
      }
    }
  }
}

TEST(ShortestPaths, OnAPrismAreStraightWhenItIsUnrolled) {
  // A cylinder of flat facets unrolls without distortion.
  constexpr int kColumns = 32;
  constexpr double kSpacing = 1.7;
  const TriangleMesh flat = test::flat_sheet(kColumns, 40, kSpacing);
  TriangleMesh rolled = flat;
  const double radius = kSpacing / 2 / std::sin(std::numbers::pi / (2 * kColumns));
  for (Eigen::Index v = 0; v < flat.vertices.cols(); ++v) {
    const double turn = std::numbers::pi / kColumns * flat.vertices(0, v) / kSpacing;
    rolled.vertices.col(v) << radius * std::cos(turn), radius * std::sin(turn), flat.vertices(1, v);
  }
  const std::vector<SurfacePoint> targets = any_places(flat, 12, 6);
  for (const SurfacePoint& from : any_places(flat, 6, 5)) {
    const auto paths = shortest_paths(rolled, std::vector{from}, targets);
    for (size_t i = 0; i < targets.size(); ++i) {
      ASSERT_TRUE(paths[i]);
      expect_straight_line(flat, *paths[i], from, targets[i]);
    }
  }
}

/// A box of twelve triangles.
TriangleMesh box(double x, double y, double z) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 8);
  for (int v = 0; v < 8; ++v)
    mesh.vertices.col(v) << (v & 1 ? x : 0), (v & 2 ? y : 0), (v & 4 ? z : 0);
  mesh.triangles.resize(3, 12);
  mesh.triangles << 0, 0, 4, 4, 0, 0, 2, 2, 0, 0, 1, 1,  //
      3, 2, 5, 7, 1, 5, 6, 7, 4, 6, 3, 7,                //
      1, 3, 7, 6, 5, 4, 7, 3, 6, 2, 7, 5;
  return mesh;
}

TEST(ShortestPaths, OfDudeneysSpiderAndFlyIsFortyFeet) {
  // A room 30 x 12 x 12, the spider on an end wall 1 below the ceiling and the fly on the other one
  // 1 above the floor: the way over five of the six walls is 40.
  const TriangleMesh room = box(30, 12, 12);
  const auto on = [&](const Vector3d& place) {
    SurfacePoint best;
    for (int t = 0; t < room.triangles.cols(); ++t) {
      Eigen::Matrix3d corners;
      for (int k = 0; k < 3; ++k) corners.col(k) = room.vertices.col(room.triangles(k, t));
      const Vector3d normal =
          (corners.col(1) - corners.col(0)).cross(corners.col(2) - corners.col(0));
      if (std::abs(normal.normalized().dot(place - corners.col(0))) > 1e-9) continue;
      Vector3d weights;
      for (int k = 0; k < 3; ++k) {
        weights[k] =
            normal.dot((corners.col((k + 1) % 3) - place).cross(corners.col((k + 2) % 3) - place)) /
            normal.squaredNorm();
      }
      if (weights.minCoeff() > -1e-9) best = {t, weights};
    }
    return best;
  };
  const auto path = one_path(room, on({0, 6, 11}), on({30, 6, 1}));
  ASSERT_TRUE(path);
  EXPECT_NEAR(path->length, 40, 40 * kPathAccuracy);
  EXPECT_NEAR(polyline_length(room, *path), 40, 40 * kPathAccuracy);
  EXPECT_LT(largest_turn(room, *path), kAngleAccuracy);
}

TEST(ShortestPaths, BeginAtTheNearestSource) {
  const TriangleMesh mesh = test::bumpy(1500, 2.0);
  const std::vector<SurfacePoint> sources = any_places(mesh, 6, 21);
  const std::vector<SurfacePoint> targets = any_places(mesh, 12, 22);
  const auto paths = shortest_paths(mesh, sources, targets);
  std::vector<std::vector<std::optional<GeodesicPath>>> of_each;
  for (const SurfacePoint& source : sources)
    of_each.push_back(shortest_paths(mesh, std::vector{source}, targets));
  for (size_t i = 0; i < targets.size(); ++i) {
    double least = kInf;
    for (const auto& of_one : of_each) least = std::min(least, of_one[i]->length);
    EXPECT_NEAR(paths[i]->length, least, kPathAccuracy * (least + mean_edge(mesh)));
    const auto source = static_cast<size_t>(paths[i]->source);
    EXPECT_LT((position(mesh, paths[i]->points.front()) - position(mesh, sources[source])).norm(),
              kPathAccuracy);
  }
}

TEST(ShortestPaths, ToThePlaceOfASourceHaveNoLength) {
  const TriangleMesh mesh = test::glove(9.0);
  for (const SurfacePoint& place : any_places(mesh, 6, 23)) {
    const auto path = one_path(mesh, place, place);
    ASSERT_TRUE(path);
    EXPECT_EQ(path->length, 0);
    EXPECT_EQ(path->points.size(), 2U);
  }
}

/// Two flat sheets; if `meet`, they have one vertex in common.
TriangleMesh two_sheets(bool meet) {
  const TriangleMesh one = test::flat_sheet(4, 3, 1);
  TriangleMesh both;
  const auto count = static_cast<int>(one.vertices.cols());
  both.vertices.resize(3, 2 * count);
  both.vertices << one.vertices, (-one.vertices).colwise() - Vector3d(meet ? 0 : 1, 0, 0);
  both.triangles.resize(3, 2 * one.triangles.cols());
  both.triangles << one.triangles, one.triangles.array() + count;
  if (meet) both.triangles = (both.triangles.array() == count).select(0, both.triangles);
  return both;
}

TEST(ShortestPaths, BetweenPartsThatAreNotConnectedAreNone) {
  const TriangleMesh mesh = two_sheets(false);
  const int other = static_cast<int>(mesh.triangles.cols()) / 2;
  const SurfacePoint here{3, {0.2, 0.3, 0.5}}, there{other + 3, {0.2, 0.3, 0.5}};
  const SurfacePoint near{8, {1, 0, 0}};
  const auto paths = shortest_paths(mesh, std::vector{here}, std::vector{near, there});
  ASSERT_TRUE(paths[0]);
  EXPECT_NEAR(paths[0]->length, (position(mesh, here) - position(mesh, near)).norm(), 1e-12);
  EXPECT_FALSE(paths[1]);
}

TEST(ShortestPaths, PassWhereSheetsMeetAtOneVertex) {
  const TriangleMesh mesh = two_sheets(true);
  const int other = static_cast<int>(mesh.triangles.cols()) / 2;
  const SurfacePoint here{9, {0.2, 0.3, 0.5}}, there{other + 14, {0.2, 0.3, 0.5}};
  const auto path = one_path(mesh, here, there);
  ASSERT_TRUE(path);
  const double truth = position(mesh, here).norm() + position(mesh, there).norm();
  EXPECT_NEAR(path->length, truth, kPathAccuracy * truth);
  EXPECT_NEAR(polyline_length(mesh, *path), truth, kPathAccuracy * truth);
}

TEST(ShortestPaths, ScaleExactlyWithTheUnitOfLength) {
  const TriangleMesh mesh = test::glove(9.0);
  const std::vector<SurfacePoint> places = any_places(mesh, 9, 31);
  const auto paths = shortest_paths(mesh, std::vector{places[0]}, places);
  for (const double scale : {0x1p-20, 0x1p20}) {
    const auto scaled = shortest_paths(test::scaled(mesh, scale), std::vector{places[0]}, places);
    for (size_t i = 0; i < places.size(); ++i) {
      EXPECT_EQ(scaled[i]->length, scale * paths[i]->length);
      EXPECT_EQ(scaled[i]->points.size(), paths[i]->points.size());
    }
  }
}

TEST(ShortestPaths, OnNeedlesAreTheStraightLine) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(0, 1);
  for (int i = 0; i < 6; ++i) {
    TriangleMesh sheet = test::flat_sheet(30, 20, 1);
    sheet.vertices.row(0) *= 1e5;
    sheet = test::moved(sheet,
                        Eigen::Isometry3d(Eigen::AngleAxisd(
                            6 * any(random), Vector3d{any(random), any(random), 1}.normalized())));
    for (const SurfacePoint& to : any_places(sheet, 12, 40)) {
      const auto path = one_path(sheet, {100 * i, {0.2, 0.3, 0.5}}, to);
      ASSERT_TRUE(path);
      const double truth =
          (position(sheet, to) - position(sheet, {100 * i, {0.2, 0.3, 0.5}})).norm();
      EXPECT_NEAR(path->length, truth, kPathAccuracy * (truth + 1));
    }
  }
}

TEST(ShortestPaths, RefuseBadInputAndNameIt) {
  const TriangleMesh mesh = test::flat_sheet(3, 3, 1);
  const std::vector<SurfacePoint> good = {corner_point(0, 0)};
  const std::vector<SurfacePoint> bad = {corner_point(0, 0), {2, {kNaN, 0.5, 0.5}}};
  EXPECT_NE(refusal([&] { return shortest_paths(mesh, {}, good); }).find("no source"),
            std::string::npos);
  EXPECT_NE(refusal([&] { return shortest_paths(mesh, bad, good); }).find("source 1"),
            std::string::npos);
  EXPECT_NE(refusal([&] { return shortest_paths(mesh, good, bad); }).find("target 1"),
            std::string::npos);
  TriangleMesh broken = mesh;
  broken.vertices(1, 2) = kNaN;
  EXPECT_NE(refusal([&] { return shortest_paths(broken, good, good); }).find("vertex 2"),
            std::string::npos);
}

/// The shortest way along edges between two vertices.
std::vector<SurfacePoint> along_edges(const TriangleMesh& mesh, int from, int to) {
  std::vector<std::vector<int>> neighbours(static_cast<size_t>(mesh.vertices.cols()));
  for (const auto& t : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      neighbours[static_cast<size_t>(t[k])].push_back(t[(k + 1) % 3]);
      neighbours[static_cast<size_t>(t[(k + 1) % 3])].push_back(t[k]);
    }
  }
  std::vector<double> distance(neighbours.size(), kInf);
  std::vector<int> before(neighbours.size(), -1);
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  queue.push({distance[static_cast<size_t>(to)] = 0, to});
  while (!queue.empty()) {
    const auto [d, v] = queue.top();
    queue.pop();
    if (d > distance[static_cast<size_t>(v)]) continue;
    for (const int w : neighbours[static_cast<size_t>(v)]) {
      const double through = d + (mesh.vertices.col(v) - mesh.vertices.col(w)).norm();
      if (!(through < distance[static_cast<size_t>(w)])) continue;
      distance[static_cast<size_t>(w)] = through;
      before[static_cast<size_t>(w)] = v;
      queue.push({through, w});
    }
  }
  const std::vector<SurfacePoint> places = vertex_points(mesh);
  std::vector<SurfacePoint> path;
  for (int v = from; v >= 0; v = before[static_cast<size_t>(v)])
    path.push_back(places[static_cast<size_t>(v)]);
  return path;
}

TEST(StraightenPath, OfEdgesIsStraightAndNoShorterThanTheShortest) {
  for (const TriangleMesh& mesh : surfaces()) {
    std::mt19937 random(17);
    std::uniform_int_distribution<int> any(0, static_cast<int>(mesh.triangles.cols()) - 1);
    for (int i = 0; i < 12; ++i) {
      const int from = mesh.triangles(0, any(random));
      const int to = mesh.triangles(1, any(random));
      const std::vector<SurfacePoint> edges = along_edges(mesh, from, to);
      if (edges.size() < 2) continue;
      const GeodesicPath straight = straighten_path(mesh, edges);
      const auto shortest = one_path(mesh, edges.front(), edges.back());
      ASSERT_TRUE(shortest);
      const double enough = kPathAccuracy * (straight.length + mean_edge(mesh));
      double before = 0;
      for (size_t k = 1; k < edges.size(); ++k)
        before += (position(mesh, edges[k]) - position(mesh, edges[k - 1])).norm();
      EXPECT_GE(straight.length, shortest->length - enough);
      EXPECT_LE(straight.length, before + enough);
      EXPECT_NEAR(polyline_length(mesh, straight), straight.length, enough);
      EXPECT_LT(largest_turn(mesh, straight), kAngleAccuracy);
    }
  }
}

TEST(StraightenPath, OfAWayWithDetoursOnAFlatSheetIsTheStraightLine) {
  const TriangleMesh sheet = test::flat_sheet(25, 25, 1.3);
  const std::vector<SurfacePoint> stops = any_places(sheet, 30, 9);
  std::vector<SurfacePoint> way = {stops[0]};
  for (size_t i = 1; i < stops.size(); ++i) {
    const auto part = one_path(sheet, stops[i - 1], stops[i]);
    ASSERT_TRUE(part);
    way.insert(way.end(), part->points.begin(), part->points.end());
  }
  const GeodesicPath straight = straighten_path(sheet, way);
  const double truth = (position(sheet, stops.back()) - position(sheet, stops.front())).norm();
  EXPECT_NEAR(straight.length, truth, kPathAccuracy * truth);
}

TEST(StraightenPath, OfAShortestPathChangesNothing) {
  for (const TriangleMesh& mesh : surfaces()) {
    const std::vector<SurfacePoint> places = any_places(mesh, 6, 51);
    for (size_t i = 1; i < places.size(); ++i) {
      const auto path = one_path(mesh, places[0], places[i]);
      if (!path) continue;
      const GeodesicPath again = straighten_path(mesh, path->points);
      EXPECT_NEAR(again.length, path->length, kPathAccuracy * (path->length + mean_edge(mesh)));
    }
  }
}

/// [rad] Total turn of a path round the z axis.
double turn_round_axis(const TriangleMesh& mesh, const GeodesicPath& path) {
  double turn = 0;
  for (size_t i = 1; i < path.points.size(); ++i) {
    const Vector3d a = position(mesh, path.points[i - 1]), b = position(mesh, path.points[i]);
    turn += std::atan2(a.x() * b.y() - a.y() * b.x(), a.x() * b.x() + a.y() * b.y());
  }
  return turn;
}

TEST(StraightenPath, RoundTheHandleOfATorusStaysRoundIt) {
  constexpr int kAround = 24, kAcross = 12;
  constexpr double kRadius = 20, kTube = 8;
  const TriangleMesh torus = test::torus(kAround, kAcross, kRadius, kTube);
  const std::vector<SurfacePoint> places = vertex_points(torus);
  // Vertices in order of their angle about the axis, on the outer ring.
  std::vector<int> ring;
  for (int v = 0; v < torus.vertices.cols(); ++v) {
    const Vector3d at = torus.vertices.col(v);
    if (std::hypot(at.x(), at.y()) > kRadius + kTube - 1e-6) ring.push_back(v);
  }
  ASSERT_EQ(ring.size(), static_cast<size_t>(kAround));
  std::sort(ring.begin(), ring.end(), [&](int a, int b) {
    return std::atan2(torus.vertices(1, a), torus.vertices(0, a)) <
           std::atan2(torus.vertices(1, b), torus.vertices(0, b));
  });
  for (const int turns : {1, 2, -1}) {
    std::vector<SurfacePoint> way;
    for (int i = 0; i <= kAround; ++i) {
      for (int k = 0; k < (i == kAround ? 1 : std::abs(turns)); ++k) {
        const int step = std::abs(turns) * i + k;
        const int at = turns > 0 ? step : 10 * kAround - step;
        way.push_back(places[static_cast<size_t>(ring[static_cast<size_t>(at % kAround)])]);
      }
    }
    const GeodesicPath straight = straighten_path(torus, way);
    EXPECT_NEAR(turn_round_axis(torus, straight), 2 * std::numbers::pi * turns, 1e-9);
    EXPECT_LT(largest_turn(torus, straight), kAngleAccuracy);
    // Not shorter than the smallest circle of the axis' hole, and shorter than the outer one.
    const double inner = 2 * kAround * (kRadius - kTube) * std::sin(std::numbers::pi / kAround);
    const double outer = 2 * kAround * (kRadius + kTube) * std::sin(std::numbers::pi / kAround);
    EXPECT_GT(straight.length, std::abs(turns) * inner * 0.999);
    EXPECT_LT(straight.length, std::abs(turns) * outer);
    EXPECT_EQ(one_path(torus, way.front(), way.back())->length, 0);
  }
}

TEST(StraightenPath, RoundAHoleOnTheLongSideBendsAtItsCorners) {
  constexpr int kCells = 5;
  constexpr double kSide = 5 * 0.7;
  const TriangleMesh plate = test::plate_with_hole(kCells, 0.7);
  // From below the hole to above it, on its left: over two of its corners.
  const auto at = [&](double x, double y) {
    const Vector3d place(x, y, 0);
    Eigen::Index v = 0;
    (plate.vertices.colwise() - place).colwise().norm().minCoeff(&v);
    return vertex_points(plate)[static_cast<size_t>(v)];
  };
  const SurfacePoint below = at(1.8 * kSide, 0.4 * kSide), above = at(1.8 * kSide, 2.6 * kSide);
  const SurfacePoint left = at(0.2 * kSide, 1.4 * kSide);
  auto way = one_path(plate, below, left)->points;
  const auto rest = one_path(plate, left, above)->points;
  way.insert(way.end(), rest.begin(), rest.end());
  const GeodesicPath straight = straighten_path(plate, way);
  const Vector3d low(kSide, kSide, 0), high(kSide, 2 * kSide, 0);
  const double truth =
      (position(plate, below) - low).norm() + kSide + (position(plate, above) - high).norm();
  EXPECT_NEAR(straight.length, truth, kPathAccuracy * truth);
  EXPECT_LT(one_path(plate, below, above)->length, 0.95 * truth);
}

TEST(StraightenPath, RefusesWhatIsNoPathAndNamesIt) {
  const TriangleMesh mesh = test::flat_sheet(6, 6, 1);
  const std::vector<SurfacePoint> alone = {corner_point(0, 0)};
  EXPECT_NE(refusal([&] { return straighten_path(mesh, alone); }).find("1 points"),
            std::string::npos);
  const std::vector<SurfacePoint> jump = {corner_point(0, 0), corner_point(0, 1),
                                          corner_point(60, 1)};
  EXPECT_NE(refusal([&] { return straighten_path(mesh, jump); }).find("point 2"),
            std::string::npos);
  const std::vector<SurfacePoint> bad = {corner_point(0, 0), {0, {kNaN, 1, 0}}};
  EXPECT_NE(refusal([&] { return straighten_path(mesh, bad); }).find("point 1"), std::string::npos);
}

}  // namespace
}  // namespace palpate::geometry
