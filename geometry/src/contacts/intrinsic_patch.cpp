// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The parts of IntrinsicTriangulation that retriangulate a polygon of triangles.
#include <algorithm>
#include <limits>

#include "contacts/intrinsic_triangulation.h"
#include "mesh/triangle_primitives.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// A point lies on an edge iff a barycentric coordinate is this close to 0.
constexpr double kOnEdge = 1e-7;

}  // namespace

void IntrinsicTriangulation::make_vertex(int id) {
  Patch& patch = split_;
  const int t = triangle_of_point(id);
  const Vector3d at = barycentric(id);
  unlink_point(id);
  int smallest = 0;
  const double least = at.minCoeff(&smallest);
  // The base lies along x, the point's smallest coordinate belongs to the apex.
  const int base = next(3 * t + smallest);
  const double l = length(base);
  const Vector2d at_apex = apex_of_lengths(l, length(previous(base)), length(next(base)));
  const int i = base % 3;
  const bool on_edge = least < kOnEdge;
  const Vector2d position = on_edge ? Vector2d(l * at[(i + 1) % 3] / (at[i] + at[(i + 1) % 3]), 0)
                                    : Vector2d(at[(i + 1) % 3] * l + at[(i + 2) % 3] * at_apex.x(),
                                               at[(i + 2) % 3] * at_apex.y());
  patch.nodes = {{.vertex = from(base), .position = {0, 0}},
                 {.vertex = to(base), .position = {l, 0}},
                 {.vertex = from(previous(base)), .position = at_apex},
                 {.vertex = id, .position = position}};
  const auto nodes_from = [](int k, Patch::Triangle nodes) {  // as seen from corner 0
    std::rotate(nodes.begin(), nodes.begin() + (3 - k) % 3, nodes.end());
    return nodes;
  };
  patch.old_triangles = {t};
  patch.old_nodes = {nodes_from(i, {0, 1, 2})};
  patch.new_nodes = {{1, 2, 3}, {2, 0, 3}};
  const int other = opposite(base);
  if (!on_edge) {
    patch.new_nodes.push_back({0, 1, 3});
  } else if (other == kNone) {
    boundary_[static_cast<size_t>(id)] = 1;
  } else {
    Vector2d at_other = apex_of_lengths(l, length(next(other)), length(previous(other)));
    at_other.y() = -at_other.y();
    patch.nodes.push_back({.vertex = from(previous(other)), .position = at_other});
    patch.old_triangles.push_back(other / 3);
    patch.old_nodes.push_back(nodes_from(other % 3, {1, 0, 4}));
    patch.new_nodes.insert(patch.new_nodes.end(), {{0, 4, 3}, {4, 1, 3}});
  }
  replace(patch);
}

void IntrinsicTriangulation::list_rim(const Patch& patch) {
  rim_.clear();
  for (size_t i = 0; i < patch.old_triangles.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) {
      const std::array<int, 2> nodes = {patch.old_nodes[i][k], patch.old_nodes[i][(k + 1) % 3]};
      const auto inner = std::ranges::find_if(rim_, [&](const RimEdge& edge) {
        return edge.nodes[0] == nodes[1] && edge.nodes[1] == nodes[0];
      });
      if (inner != rim_.end()) {
        *inner = rim_.back();
        rim_.pop_back();
        continue;
      }
      const int h = 3 * patch.old_triangles[i] + static_cast<int>(k);
      rim_.push_back({.nodes = nodes,
                      .old_half_edge = h,
                      .opposite = opposite(h),
                      .length = length(h),
                      .new_half_edge = kNone});
    }
  }
}

void IntrinsicTriangulation::glue_patch(const Patch& patch) {
  for (size_t i = 0; i < patch.new_nodes.size(); ++i) {
    for (size_t k = 0; k < 3; ++k) {
      const int h = 3 * patch.new_triangles[i] + static_cast<int>(k);
      const int start = patch.new_nodes[i][k];
      const int end = patch.new_nodes[i][(k + 1) % 3];
      const auto rim = std::ranges::find(rim_, std::array{start, end}, &RimEdge::nodes);
      Triangle& triangle = triangles_[static_cast<size_t>(h / 3)];
      if (rim != rim_.end()) {
        rim->new_half_edge = h;
        triangle.length[k] = rim->length;
        continue;
      }
      triangle.length[k] = (patch.nodes[static_cast<size_t>(end)].position -
                            patch.nodes[static_cast<size_t>(start)].position)
                               .norm();
      for (size_t j = 0; j < i; ++j) {
        for (size_t m = 0; m < 3; ++m) {
          if (patch.new_nodes[j][m] == end && patch.new_nodes[j][(m + 1) % 3] == start) {
            glue(h, 3 * patch.new_triangles[j] + static_cast<int>(m));
            triangle.length[k] = triangles_[static_cast<size_t>(patch.new_triangles[j])].length[m];
          }
        }
      }
    }
  }
  for (const RimEdge& edge : rim_) {
    if (edge.new_half_edge == kNone) continue;
    // The rim may be joined to itself.
    const auto self = std::ranges::find(rim_, edge.opposite, &RimEdge::old_half_edge);
    const bool is_self = edge.opposite != kNone && self != rim_.end();
    glue(edge.new_half_edge, is_self ? self->new_half_edge : edge.opposite);
  }
}

void IntrinsicTriangulation::replace(Patch& patch) {
  list_rim(patch);
  moving_.clear();
  for (size_t i = 0; i < patch.old_triangles.size(); ++i) {
    const int t = patch.old_triangles[i];
    for (int id = first_point(t); id != kNone; id = next_point(id)) {
      Vector2d at(0, 0);
      for (size_t k = 0; k < 3; ++k) {
        at += barycentric(id)[static_cast<Eigen::Index>(k)] *
              patch.nodes[static_cast<size_t>(patch.old_nodes[i][k])].position;
      }
      moving_.emplace_back(id, at);
    }
    triangles_[static_cast<size_t>(t)].corner[0] = kNone;
    free_.push_back(t);
  }
  patch.new_triangles.clear();
  for (const Patch::Triangle& nodes : patch.new_nodes) {
    if (free_.empty()) {
      free_.push_back(triangle_slots());
      triangles_.emplace_back();
    }
    const int t = free_.back();
    free_.pop_back();
    patch.new_triangles.push_back(t);
    Triangle& triangle = triangles_[static_cast<size_t>(t)];
    triangle.first_point = kNone;
    triangle.opposite = {kNone, kNone, kNone};
    for (size_t k = 0; k < 3; ++k) {
      triangle.corner[k] = patch.nodes[static_cast<size_t>(nodes[k])].vertex;
    }
  }
  glue_patch(patch);
  for (const int t : patch.new_triangles) update_out(t);
  for (const auto& [id, at] : moving_) place_point(id, at, patch);
}

void IntrinsicTriangulation::place_point(int id, const Vector2d& at, const Patch& patch) {
  // The triangle that contains it, or the one that it is least outside of.
  double best_least = -std::numeric_limits<double>::infinity();
  int best = patch.new_triangles.front();
  Vector3d best_coordinates(1, 0, 0);
  for (size_t i = 0; i < patch.new_nodes.size() && best_least < 0; ++i) {
    const auto position = [&](size_t k) -> const Vector2d& {
      return patch.nodes[static_cast<size_t>(patch.new_nodes[i][k])].position;
    };
    const Vector2d a = position(0) - at;
    const Vector2d b = position(1) - at;
    const Vector2d c = position(2) - at;
    const Vector3d areas(cross(b, c), cross(c, a), cross(a, b));
    const double sum = areas.sum();
    if (!(sum > 0)) continue;
    const double least = areas.minCoeff() / sum;
    if (!(least > best_least)) continue;
    best_least = least;
    best = patch.new_triangles[i];
    best_coordinates = areas / sum;
  }
  best_coordinates = best_coordinates.cwiseMax(0);
  points_[static_cast<size_t>(id)].barycentric = best_coordinates / best_coordinates.sum();
  push_point(id, best);
}

void IntrinsicTriangulation::retire_vertex(int v, const Patch& patch) {
  out_[static_cast<size_t>(v)] = kNone;
  place_point(v, Vector2d(0, 0), patch);
}

}  // namespace palpate::geometry
