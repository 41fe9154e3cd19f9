// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "surface_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>

namespace palpate::view {
namespace {

VertexRange range_of(const std::vector<int>& vertices) {
  if (vertices.empty()) return {};
  const auto [low, high] = std::ranges::minmax_element(vertices);
  return {*low, *high + 1};
}

VertexRange both(const VertexRange& a, const VertexRange& b) {
  if (a.begin == a.end) return b;
  if (b.begin == b.end) return a;
  return {std::min(a.begin, b.begin), std::max(a.end, b.end)};
}

}  // namespace

SurfaceShape::SurfaceShape(geometry::TriangleMesh surface) : surface_(std::move(surface)) {
  geometry::check_mesh(surface_, "SurfaceShape");
  const auto count = static_cast<std::size_t>(surface_.vertices.cols());
  first_.assign(count + 1, 0);
  for (const int v : surface_.triangles.reshaped()) ++first_[static_cast<std::size_t>(v) + 1];
  std::partial_sum(first_.begin(), first_.end(), first_.begin());
  fans_.resize(static_cast<std::size_t>(surface_.triangles.size()));
  std::vector<int> next(first_.begin(), first_.end() - 1);
  for (Eigen::Index t = 0; t < surface_.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int v = surface_.triangles(k, t);
      fans_[static_cast<std::size_t>(next[static_cast<std::size_t>(v)]++)] = static_cast<int>(t);
      const int w = surface_.triangles((k + 1) % 3, t);
      longest_edge_ =
          std::max(longest_edge_, (surface_.vertices.col(v) - surface_.vertices.col(w)).norm());
    }
  }
  positions_ = surface_.vertices.cast<float>();
  normals_.setZero(3, positions_.cols());
  moved_.setZero(positions_.cols());
  local_.assign(count, -1);
  std::vector<int> all(count);
  std::iota(all.begin(), all.end(), 0);
  update_normals(all);
}

// Vertices on the way along the surface to which everything within `radius` lies, and more.
std::vector<int> SurfaceShape::near(const geometry::SurfacePoint& contact, double radius) {
  const Eigen::Vector3d place = geometry::position(surface_, contact);
  // Triangles that a way of this length crosses have all of their corners in this distance.
  const double reach = radius + longest_edge_;
  std::vector<int> found;
  const auto add = [&](int triangle) {
    for (const int v : surface_.triangles.col(triangle)) {
      if (local_[static_cast<std::size_t>(v)] >= 0) continue;
      local_[static_cast<std::size_t>(v)] = static_cast<int>(found.size());
      found.push_back(v);
    }
  };
  add(contact.triangle);
  for (std::size_t i = 0; i < found.size(); ++i) {
    const auto v = static_cast<std::size_t>(found[i]);
    if ((surface_.vertices.col(found[i]) - place).norm() > reach) continue;
    for (int f = first_[v]; f < first_[v + 1]; ++f) add(fans_[static_cast<std::size_t>(f)]);
  }
  return found;
}

VertexRange SurfaceShape::deform(const geometry::SurfacePoint& contact,
                                 const Eigen::Vector3d& displacement,
                                 const haptics::DrawnShapeOptions& options) {
  const VertexRange before = range_of(changed_);
  const std::vector<int> old = changed_;
  restore();
  const double radius = options.tip + options.reach * displacement.norm();
  changed_ = near(contact, radius);
  // The part of the surface around the contact, in which the dent is the same as in the whole.
  geometry::TriangleMesh part;
  part.vertices = surface_.vertices(Eigen::all, changed_);
  std::vector<int> triangles;
  for (const int v : changed_) {
    for (int f = first_[static_cast<std::size_t>(v)]; f < first_[static_cast<std::size_t>(v) + 1];
         ++f) {
      const int t = fans_[static_cast<std::size_t>(f)];
      // Each triangle once: by its first corner, if all corners are in the part.
      if (surface_.triangles(0, t) != v) continue;
      const auto is_in = [&](int w) { return local_[static_cast<std::size_t>(w)] >= 0; };
      if (is_in(surface_.triangles(1, t)) && is_in(surface_.triangles(2, t)))
        triangles.push_back(t);
    }
  }
  part.triangles.resize(3, static_cast<Eigen::Index>(triangles.size()));
  geometry::SurfacePoint at = contact;
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    if (triangles[i] == contact.triangle) at.triangle = static_cast<int>(i);
    for (int k = 0; k < 3; ++k) {
      part.triangles(k, static_cast<Eigen::Index>(i)) =
          local_[static_cast<std::size_t>(surface_.triangles(k, triangles[i]))];
    }
  }
  const Eigen::Matrix3Xd shape = haptics::drawn_shape(part, at, displacement, options);
  for (std::size_t i = 0; i < changed_.size(); ++i) {
    const int v = changed_[i];
    local_[static_cast<std::size_t>(v)] = -1;
    const auto column = static_cast<Eigen::Index>(i);
    positions_.col(v) = shape.col(column).cast<float>();
    moved_[v] = static_cast<float>((shape.col(column) - surface_.vertices.col(v)).norm());
  }
  update_normals(old);
  update_normals(changed_);
  return both(before, range_of(changed_));
}

VertexRange SurfaceShape::show(const Eigen::Matrix3Xd& vertices) {
  positions_ = vertices.cast<float>();
  moved_ = (vertices - surface_.vertices).colwise().norm().transpose().cast<float>();
  changed_.resize(static_cast<std::size_t>(vertices.cols()));
  std::iota(changed_.begin(), changed_.end(), 0);
  update_normals(changed_);
  return {0, vertices.cols()};
}

VertexRange SurfaceShape::rest() {
  const VertexRange before = range_of(changed_);
  const std::vector<int> old = changed_;
  restore();
  update_normals(old);
  return before;
}

void SurfaceShape::restore() {
  for (const int v : changed_) {
    positions_.col(v) = surface_.vertices.col(v).cast<float>();
    moved_[v] = 0;
  }
  changed_.clear();
}

void SurfaceShape::update_normals(const std::vector<int>& vertices) {
  for (const int v : vertices) {
    Eigen::Vector3f sum = Eigen::Vector3f::Zero();
    for (int f = first_[static_cast<std::size_t>(v)]; f < first_[static_cast<std::size_t>(v) + 1];
         ++f) {
      const Eigen::Vector3i corners = surface_.triangles.col(fans_[static_cast<std::size_t>(f)]);
      const Eigen::Vector3f a = positions_.col(corners[0]);
      sum += (positions_.col(corners[1]) - a).cross(positions_.col(corners[2]) - a);
    }
    const float length = sum.norm();
    normals_.col(v) = length > 0 ? Eigen::Vector3f(sum / length) : Eigen::Vector3f::Zero();
  }
}

}  // namespace palpate::view
