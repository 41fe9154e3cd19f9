// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The parts of IntrinsicTriangulation that remove triangles without area.
#include <algorithm>

#include "contacts/intrinsic_triangulation.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

/// An edge has no length iff it is at most this fraction of the longest edge of each of its
/// triangles: the rounding of coordinates, far below any measured length.
constexpr double kNoLength = 1e-9;

/// After lengthening, the sum of two sides of a triangle exceeds the third by at least this
/// fraction of the mean edge. Large relative to rounding, small relative to any measurement error.
constexpr double kMollification = 1e-6;

std::vector<int> neighbours(const IntrinsicTriangulation& surface, int v) {
  std::vector<int> result;
  surface.fan(v, result);
  const int last = IntrinsicTriangulation::previous(result.back());
  for (int& h : result) h = surface.to(h);
  if (surface.is_boundary(v)) result.push_back(surface.from(last));
  return result;
}

}  // namespace

void IntrinsicTriangulation::remove_degenerate_triangles() {
  // A collapse may make room for one that was not possible before.
  for (bool is_changed = true; is_changed;) {
    is_changed = false;
    for (int h = 0; h < 3 * triangle_slots(); ++h) {
      if (is_alive(h / 3) && has_no_length(h) && collapse(h)) is_changed = true;
    }
  }
  double lengthening = 0;
  for (int t = 0; t < triangle_slots(); ++t) {
    if (!is_alive(t)) continue;
    const auto [a, b, c] = triangles_[static_cast<size_t>(t)].length;
    const double slack = std::min({a + b - c, b + c - a, c + a - b});
    lengthening = std::max(lengthening, kMollification - slack);
  }
  if (lengthening == 0) return;
  for (Triangle& triangle : triangles_) {
    for (double& l : triangle.length) l += lengthening;
  }
}

bool IntrinsicTriangulation::has_no_length(int h) const {
  double longest = std::ranges::max(triangle(h).length);
  if (opposite(h) != kNone) {
    longest = std::min(longest, std::ranges::max(triangle(opposite(h)).length));
  }
  return length(h) <= kNoLength * longest;
}

// The link condition (Dey, Edelsbrunner, Guha and Nekhayev 1999): the ends have no common neighbour
// but the third corners of the triangles at the edge, each of which keeps a triangle.
bool IntrinsicTriangulation::may_collapse(int h) const {
  const int other = opposite(h);
  if (other != kNone && is_boundary(from(h)) && is_boundary(to(h))) return false;
  std::vector<int> third;
  for (const int side : {h, other}) {
    if (side == kNone) continue;
    third.push_back(from(previous(side)));
    const int right = opposite(next(side));
    const int left = opposite(previous(side));
    if (right == kNone && left == kNone) return false;
    const bool is_corner = right != kNone && left != kNone;
    if (is_corner && from(previous(right)) == from(previous(left))) return false;
  }
  if (third.front() == third.back() && third.size() > 1) return false;
  const std::vector<int> around = neighbours(*this, from(h));
  return std::ranges::none_of(neighbours(*this, to(h)), [&](int v) {
    return std::ranges::find(third, v) == third.end() &&
           std::ranges::find(around, v) != around.end();
  });
}

//      c              c
//    /   \            |
//   a --- b    ->     a      where the outer triangles at b c and c a become neighbours
//    \   /            |
//      d              d
bool IntrinsicTriangulation::collapse(int h) {
  if (!may_collapse(h)) return false;
  const int a = from(h);
  const int b = to(h);
  std::vector<int> around;
  fan(b, around);
  for (const int out_of_b : around) {
    triangles_[static_cast<size_t>(out_of_b / 3)].corner[static_cast<size_t>(out_of_b % 3)] = a;
  }
  if (is_boundary(b)) boundary_[static_cast<size_t>(a)] = 1;
  std::vector<int> ways_out;  // of a and of the third corners
  for (const int side : {h, opposite(h)}) {
    if (side == kNone) continue;
    const int out_of_third = opposite(next(side));
    const int out_of_a = opposite(previous(side));
    if (out_of_third != kNone && out_of_a != kNone) {
      glue(out_of_third, out_of_a);
      triangles_[static_cast<size_t>(out_of_third / 3)]
          .length[static_cast<size_t>(out_of_third % 3)] = length(out_of_a);
    } else {
      glue(std::max(out_of_third, out_of_a), kNone);
    }
    ways_out.push_back(out_of_a != kNone ? out_of_a : next(out_of_third));
    ways_out.push_back(out_of_third != kNone ? out_of_third : next(out_of_a));
    for (int id = first_point(side / 3); id != kNone;) {
      const int following = next_point(id);
      const double at_third = barycentric(id)[previous(side) % 3];
      const int at = ways_out[ways_out.size() - 2];
      points_[static_cast<size_t>(id)].barycentric =
          (1 - at_third) * Vector3d::Unit(at % 3) +
          at_third * Vector3d::Unit((at == out_of_a ? next(at) : previous(at)) % 3);
      push_point(id, at / 3);
      id = following;
    }
    triangles_[static_cast<size_t>(side / 3)].corner[0] = kNone;
    free_.push_back(side / 3);
  }
  for (const int way : ways_out) out_[static_cast<size_t>(from(way))] = first_of_fan(way);
  out_[static_cast<size_t>(b)] = kNone;
  points_[static_cast<size_t>(b)].barycentric = Vector3d::Unit(out(a) % 3);
  push_point(b, out(a) / 3);
  return true;
}

}  // namespace palpate::geometry
