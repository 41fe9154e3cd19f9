// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "contacts/intrinsic_triangulation.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mesh/triangle_primitives.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// An edge is flipped iff the angles opposite it exceed pi by more than rounding, so that flipping
/// terminates; relative to squared sides times areas.
constexpr double kDelaunayRounding = 1e-12;

/// A quadrilateral is strictly convex iff its diagonals cross at least this fraction of the
/// diagonal away from the ends.
constexpr double kConvexMargin = 1e-12;

}  // namespace

IntrinsicTriangulation::IntrinsicTriangulation(const TriangleMesh& mesh) {
  const Eigen::Matrix3Xi opposite_of = opposite_half_edges(mesh);
  triangles_.resize(static_cast<size_t>(mesh.triangles.cols()));
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    Triangle& triangle = triangles_[static_cast<size_t>(t)];
    triangle.first_point = kNone;
    for (int k = 0; k < 3; ++k) {
      triangle.corner[static_cast<size_t>(k)] = mesh.triangles(k, t);
      triangle.opposite[static_cast<size_t>(k)] = opposite_of(k, t);
    }
  }
  const auto vertex_count = static_cast<int>(mesh.vertices.cols());
  measure(mesh);
  for (int v = 0; v < vertex_count; ++v) add_id();
  separate_fans(vertex_count);
}

void IntrinsicTriangulation::measure(const TriangleMesh& mesh) {
  double sum = 0;
  for (size_t t = 0; t < triangles_.size(); ++t) {
    Triangle& triangle = triangles_[t];
    for (size_t k = 0; k < 3; ++k) {
      const auto difference =
          mesh.vertices.col(triangle.corner[(k + 1) % 3]) - mesh.vertices.col(triangle.corner[k]);
      triangle.length[k] = difference.stableNorm();
      // Bitwise equal on both sides.
      const int other = triangle.opposite[k];
      if (other != kNone && other < static_cast<int>(3 * t + k)) triangle.length[k] = length(other);
      sum += triangle.length[k];
    }
  }
  unit_ = sum > 0 ? sum / (3 * static_cast<double>(triangles_.size())) : 1;
  for (Triangle& triangle : triangles_) {
    for (double& l : triangle.length) l /= unit_;
  }
}

int IntrinsicTriangulation::add_id() {
  points_.emplace_back();
  out_.push_back(kNone);
  boundary_.push_back(0);
  fan_of_.push_back(id_count() - 1);
  return id_count() - 1;
}

void IntrinsicTriangulation::separate_fans(int vertex_count) {
  std::vector<char> visited(3 * triangles_.size(), 0);
  std::vector<char> has_fan(static_cast<size_t>(vertex_count), 0);
  for (int begin = 0; begin < static_cast<int>(visited.size()); ++begin) {
    if (visited[static_cast<size_t>(begin)] != 0) continue;
    const int v = from(begin);
    const int first = first_of_fan(begin);
    int id = v;
    if (has_fan[static_cast<size_t>(v)] != 0) {
      id = add_id();
      fan_of_.back() = v;
    }
    has_fan[static_cast<size_t>(v)] = 1;
    out_[static_cast<size_t>(id)] = first;
    boundary_[static_cast<size_t>(id)] = opposite(first) == kNone ? 1 : 0;
    int h = first;
    do {
      visited[static_cast<size_t>(h)] = 1;
      triangles_[static_cast<size_t>(h / 3)].corner[static_cast<size_t>(h % 3)] = id;
      h = opposite(previous(h));
    } while (h != kNone && h != first);
  }
}

int IntrinsicTriangulation::first_of_fan(int begin) const {
  int h = begin;
  while (opposite(h) != kNone) {
    h = next(opposite(h));
    if (h == begin) break;
  }
  return h;
}

void IntrinsicTriangulation::fan(int v, std::vector<int>& half_edges) const {
  half_edges.clear();
  const int first = out(v);
  int h = first;
  do {
    half_edges.push_back(h);
    h = opposite(previous(h));
  } while (h != kNone && h != first);
}

bool IntrinsicTriangulation::are_joined(int a, int b) const {
  const int first = out(a);
  int h = first;
  do {
    if (to(h) == b || from(previous(h)) == b) return true;
    h = opposite(previous(h));
  } while (h != kNone && h != first);
  return false;
}

int IntrinsicTriangulation::track(int t, const Vector3d& barycentric) {
  const int id = add_id();
  points_.back().barycentric = barycentric;
  push_point(id, t);
  return id;
}

void IntrinsicTriangulation::push_point(int id, int t) {
  Point& point = points_[static_cast<size_t>(id)];
  point.triangle = t;
  point.next = std::exchange(triangles_[static_cast<size_t>(t)].first_point, id);
}

void IntrinsicTriangulation::unlink_point(int id) {
  int* link = &triangles_[static_cast<size_t>(triangle_of_point(id))].first_point;
  while (*link != id) link = &points_[static_cast<size_t>(*link)].next;
  *link = next_point(id);
}

void IntrinsicTriangulation::glue(int h, int other) {
  triangles_[static_cast<size_t>(h / 3)].opposite[static_cast<size_t>(h % 3)] = other;
  if (other == kNone) return;
  triangles_[static_cast<size_t>(other / 3)].opposite[static_cast<size_t>(other % 3)] = h;
}

void IntrinsicTriangulation::update_out(int t) {
  for (int h = 3 * t; h < 3 * t + 3; ++h) {
    // A border vertex keeps the half-edge at which its border begins.
    if (opposite(h) == kNone || !is_boundary(from(h))) out_[static_cast<size_t>(from(h))] = h;
  }
}

bool IntrinsicTriangulation::is_delaunay(int h) const {
  const Triangle& here = triangle(h);
  const Triangle& there = triangle(opposite(h));
  const auto i = static_cast<size_t>(h % 3);
  const auto j = static_cast<size_t>(opposite(h) % 3);
  const double l = here.length[i];
  const double a = here.length[(i + 1) % 3];
  const double b = here.length[(i + 2) % 3];
  const double c = there.length[(j + 1) % 3];
  const double d = there.length[(j + 2) % 3];
  // cot + cot >= 0, multiplied by both areas so that it includes triangles without area.
  const double cosine = a * a + (b - l) * (b + l);
  const double other_cosine = c * c + (d - l) * (d + l);
  if (cosine >= 0 && other_cosine >= 0) return true;
  const double area = area_of_lengths(l, a, b);
  const double other_area = area_of_lengths(l, c, d);
  // Two opposite right angles leave only the rounding error of the squares.
  const double size = (a * a + b * b + l * l) * other_area + (c * c + d * d + l * l) * area;
  return cosine * other_area + other_cosine * area >= -kDelaunayRounding * size;
}

//       c                c
//     / | \            /   \      .
//    a--+--b    ->    a-----b     with the half-edge a -> b replaced by c -> d
//     \ | /            \   /      .
//       d                d
bool IntrinsicTriangulation::flip(int h) {
  const int o = opposite(h);
  if (o == kNone || o / 3 == h / 3) return false;
  const int t0 = h / 3;
  const int t1 = o / 3;
  const std::array<int, 4> rim = {next(h), previous(h), next(o), previous(o)};  // bc, ca, ad, db
  const std::array<int, 4> moved = {3 * t0 + 2, 3 * t1 + 1, 3 * t1 + 2, 3 * t0 + 1};
  const double l = length(h);
  const Vector2d at_c = apex_of_lengths(l, length(rim[1]), length(rim[0]));
  Vector2d at_d = apex_of_lengths(l, length(rim[2]), length(rim[3]));
  at_d.y() = -at_d.y();
  const double height = at_c.y() - at_d.y();
  const double crossing = (at_d.x() * at_c.y() - at_c.x() * at_d.y()) / height;
  if (!(crossing > kConvexMargin * l && crossing < (1 - kConvexMargin) * l)) return false;
  const Vector2d at_b(l, 0);
  const Vector2d at_a(0, 0);
  const double diagonal = (at_c - at_d).norm();

  moving_.clear();
  for (const int half_edge : {h, o}) {
    const std::array<Vector2d, 3> corners =
        half_edge == h ? std::array{at_a, at_b, at_c} : std::array{at_b, at_a, at_d};
    const int k = half_edge % 3;
    for (int id = first_point(half_edge / 3); id != kNone; id = next_point(id)) {
      const Vector3d& at = barycentric(id);
      moving_.emplace_back(
          id, at[k] * corners[0] + at[(k + 1) % 3] * corners[1] + at[(k + 2) % 3] * corners[2]);
    }
  }

  std::array<int, 4> opposites{};
  std::array<double, 4> lengths{};
  for (size_t i = 0; i < 4; ++i) {
    opposites[i] = opposite(rim[i]);
    lengths[i] = length(rim[i]);
    for (size_t j = 0; j < 4; ++j) {
      if (opposites[i] == rim[j]) {
        opposites[i] = moved[j];
        break;
      }
    }
  }
  const int a = from(h);
  const int b = from(o);
  const int c = from(rim[1]);
  const int d = from(rim[3]);
  triangles_[static_cast<size_t>(t0)] = {.length = {diagonal, lengths[3], lengths[0]},
                                         .corner = {c, d, b},
                                         .opposite = {3 * t1, kNone, kNone},
                                         .first_point = kNone};
  triangles_[static_cast<size_t>(t1)] = {.length = {diagonal, lengths[1], lengths[2]},
                                         .corner = {d, c, a},
                                         .opposite = {3 * t0, kNone, kNone},
                                         .first_point = kNone};
  for (size_t i = 0; i < 4; ++i) glue(moved[i], opposites[i]);
  update_out(t0);
  update_out(t1);

  const Vector2d down = at_d - at_c;
  const double right_area = cross(down, at_b - at_c);
  const double left_area = cross(down, at_a - at_c);
  for (const auto& [id, at] : moving_) {
    const double side = cross(down, at - at_c);
    const bool right = side >= 0;
    // Coordinate of the corner off the diagonal, then of c.
    const double far = std::min(1.0, side / (right ? right_area : left_area));
    const Vector2d& corner = right ? at_b : at_a;
    const double at_end = std::clamp(
        (cross(at_d - at, corner - at) / (right ? right_area : left_area)), 0.0, 1 - far);
    points_[static_cast<size_t>(id)].barycentric =
        right ? Vector3d(at_end, 1 - far - at_end, far) : Vector3d(1 - far - at_end, at_end, far);
    push_point(id, right ? t0 : t1);
  }
  return true;
}

}  // namespace palpate::geometry
