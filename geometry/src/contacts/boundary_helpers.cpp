// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "contacts/boundary_helpers.h"

#include <algorithm>
#include <cmath>

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;

/// Largest deviation of the border from the polygon of helpers, as a fraction of the spacing: small
/// relative to a triangle of contacts, large relative to the steps of a border along pixels.
constexpr double kDeviation = 0.1;

/// A chain of the border between two helpers is split iff it is longer than this many spacings.
constexpr double kLongestChain = 1.5;

constexpr int kLeastHelpers = 3;

double distance_to_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
  const Vector3d along = b - a;
  const double squared = along.squaredNorm();
  const double s = squared > 0 ? std::clamp((p - a).dot(along) / squared, 0.0, 1.0) : 0;
  return (p - a - s * along).norm();
}

/// A loop of the border, starting at some vertex.
class Loop {
 public:
  Loop(const IntrinsicTriangulation& surface, const Eigen::Matrix3Xd& positions, int first)
      : positions_(positions) {
    int v = first;
    do {
      vertices_.push_back(v);
      arc_.push_back(arc_.empty()
                         ? 0
                         : arc_.back() +
                               (at(vertices_.size() - 1) - at(vertices_.size() - 2)).norm());
      v = surface.to(surface.out(v));
    } while (v != first);
    arc_.push_back(arc_.back() + (at(0) - at(vertices_.size() - 1)).norm());
  }

  [[nodiscard]] const std::vector<int>& vertices() const { return vertices_; }

  void pin(double spacing, std::vector<char>& pinned) const {
    const auto is_pinned = [&](size_t i) -> char& {
      return pinned[static_cast<size_t>(vertices_[i % vertices_.size()])];
    };
    const auto count = [&] {
      return std::ranges::count_if(vertices_,
                                   [&](int v) { return pinned[static_cast<size_t>(v)] != 0; });
    };
    if (count() == 0) is_pinned(0) = 1;
    while (count() < kLeastHelpers) {
      // The vertex farthest along the loop from those that are pinned.
      size_t best = 0;
      double furthest = -1;
      for (size_t i = 0; i < vertices_.size(); ++i) {
        double nearest = is_pinned(i) != 0 ? -1 : arc_.back();
        for (size_t j = 0; j < vertices_.size() && nearest > furthest; ++j) {
          if (is_pinned(j) == 0) continue;
          const double way = std::abs(arc_[i] - arc_[j]);
          nearest = std::min({nearest, way, arc_.back() - way});
        }
        if (nearest <= furthest) continue;
        furthest = nearest;
        best = i;
      }
      is_pinned(best) = 1;
    }
    std::vector<size_t> pins;
    for (size_t i = 0; i < vertices_.size(); ++i) {
      if (is_pinned(i) != 0) pins.push_back(i);
    }
    pins.push_back(pins.front() + vertices_.size());
    std::vector<std::pair<size_t, size_t>> chains;
    for (size_t i = 0; i + 1 < pins.size(); ++i) chains.emplace_back(pins[i], pins[i + 1]);
    while (!chains.empty()) {
      const auto [begin, end] = chains.back();
      chains.pop_back();
      const size_t middle = cut(begin, end, spacing);
      if (middle == begin) continue;
      is_pinned(middle) = 1;
      chains.emplace_back(begin, middle);
      chains.emplace_back(middle, end);
    }
  }

 private:
  [[nodiscard]] Vector3d at(size_t i) const {
    return positions_.col(vertices_[i % vertices_.size()]);
  }
  [[nodiscard]] double arc(size_t i) const {
    return i < vertices_.size() ? arc_[i] : arc_.back() + arc_[i - vertices_.size()];
  }

  /// The index at which the chain has to be split; `begin` if this is not needed or not possible.
  [[nodiscard]] size_t cut(size_t begin, size_t end, double spacing) const {
    if (end - begin < 2) return begin;
    size_t furthest = begin;
    double deviation = kDeviation * spacing;
    for (size_t i = begin + 1; i < end; ++i) {
      const double distance = distance_to_segment(at(i), at(begin), at(end));
      if (distance <= deviation) continue;
      deviation = distance;
      furthest = i;
    }
    if (furthest != begin || arc(end) - arc(begin) <= kLongestChain * spacing) return furthest;
    const double half = (arc(begin) + arc(end)) / 2;
    size_t middle = begin + 1;
    while (middle + 1 < end && arc(middle) < half) ++middle;
    return middle;
  }

  const Eigen::Matrix3Xd& positions_;
  std::vector<int> vertices_;
  std::vector<double> arc_;  ///< [mm] from the first vertex; the last entry is the whole length
};

}  // namespace

void pin_border(const IntrinsicTriangulation& surface, const Eigen::Matrix3Xd& positions,
                const std::vector<double>& spacing_of_triangle, std::vector<char>& pinned) {
  std::vector<char> visited(static_cast<size_t>(surface.id_count()), 0);
  for (int v = 0; v < surface.id_count(); ++v) {
    if (!surface.is_vertex(v) || !surface.is_boundary(v) || visited[static_cast<size_t>(v)] != 0) {
      continue;
    }
    const Loop loop(surface, positions, v);
    for (const int u : loop.vertices()) visited[static_cast<size_t>(u)] = 1;
    loop.pin(spacing_of_triangle[static_cast<size_t>(surface.out(v) / 3)], pinned);
  }
}

}  // namespace palpate::geometry
