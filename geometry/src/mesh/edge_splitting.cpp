// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/edge_splitting.h"

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::geometry {
namespace {

using CornerIndices = std::array<int, 3>;
using IsLong = std::function<bool(const Eigen::Vector3d&, const Eigen::Vector3d&)>;

constexpr int kWhole = -1;  // in place of the middle of an edge that is not split

class Splitter {
 public:
  Splitter(const TriangleMesh& mesh, const IsLong& is_long) : is_long_(is_long) {
    vertices_.reserve(static_cast<std::size_t>(mesh.vertices.cols()));
    for (const auto& vertex : mesh.vertices.colwise()) vertices_.emplace_back(vertex);
    for (const auto& corners : mesh.triangles.colwise())
      parts_.push_back({corners[0], corners[1], corners[2]});
  }

  // Both triangles of an edge are made in the same round, in which it is judged.
  SplitMesh run() {
    const auto given = static_cast<Eigen::Index>(vertices_.size());
    std::vector<CornerIndices> finished;
    while (!parts_.empty()) {
      const std::vector<CornerIndices> triangles = std::exchange(parts_, {});
      middles_.clear();
      for (const CornerIndices& triangle : triangles)
        if (!split(triangle)) finished.push_back(triangle);
    }
    SplitMesh result;
    result.mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices_.size()));
    for (Eigen::Index v = 0; v < result.mesh.vertices.cols(); ++v)
      result.mesh.vertices.col(v) = vertices_[static_cast<std::size_t>(v)];
    result.mesh.triangles.resize(3, static_cast<Eigen::Index>(finished.size()));
    for (Eigen::Index t = 0; t < result.mesh.triangles.cols(); ++t) {
      const CornerIndices& corners = finished[static_cast<std::size_t>(t)];
      result.mesh.triangles.col(t) << corners[0], corners[1], corners[2];
    }
    result.ends.resize(2, static_cast<Eigen::Index>(vertices_.size()) - given);
    for (Eigen::Index i = 0; i < result.ends.cols(); ++i) {
      const auto [low, high] = ends_[static_cast<std::size_t>(i)];
      result.ends.col(i) << low, high;
    }
    return result;
  }

 private:
  [[nodiscard]] const Eigen::Vector3d& at(int v) const {
    return vertices_[static_cast<std::size_t>(v)];
  }

  int middle(int from, int to) {
    const std::pair<int, int> ends = std::minmax(from, to);
    const Eigen::Vector3d a = at(ends.first), b = at(ends.second), between = (a + b) / 2;
    if (!is_long_(a, b) || between == a || between == b) return kWhole;
    if (vertices_.size() == std::numeric_limits<int>::max())
      throw InvalidInput("split_edges(): the mesh would have more than 2^31 - 1 vertices");
    const auto [found, is_new] = middles_.try_emplace(ends, static_cast<int>(vertices_.size()));
    if (is_new) {
      vertices_.push_back(between);
      ends_.push_back(ends);
    }
    return found->second;
  }

  // Returns true if a triangle has a long edge and was replaced by its parts.
  bool split(CornerIndices corners) {
    std::array<int, 3> middles{};
    for (std::size_t k = 0; k < 3; ++k) middles[k] = middle(corners[k], corners[(k + 1) % 3]);
    const auto count = 3 - std::ranges::count(middles, kWhole);
    if (count == 0) return false;
    // Begin with the split edge where one is split, before the whole one where two are.
    while (count < 3 && (middles[0] == kWhole || (count == 2 && middles[2] != kWhole))) {
      std::rotate(corners.begin(), corners.begin() + 1, corners.end());
      std::rotate(middles.begin(), middles.begin() + 1, middles.end());
    }
    const auto [a, b, c] = corners;
    const auto [ab, bc, ca] = middles;
    if (count == 1) {
      parts_.insert(parts_.end(), {{a, ab, c}, {ab, b, c}});
    } else if (count == 2) {
      parts_.push_back({ab, b, bc});
      if ((at(a) - at(bc)).squaredNorm() <= (at(ab) - at(c)).squaredNorm())
        parts_.insert(parts_.end(), {{a, ab, bc}, {a, bc, c}});
      else
        parts_.insert(parts_.end(), {{a, ab, c}, {ab, bc, c}});
    } else {
      parts_.insert(parts_.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
    }
    return true;
  }

  const IsLong& is_long_;
  std::vector<Eigen::Vector3d> vertices_;
  std::vector<std::pair<int, int>> ends_;  // of the edges in whose middles the new vertices lie
  std::vector<CornerIndices> parts_;       // triangles that are still to be judged
  std::map<std::pair<int, int>, int> middles_;
};

}  // namespace

SplitMesh split_edges(const TriangleMesh& mesh, const IsLong& is_long) {
  check_mesh(mesh, "split_edges");
  return Splitter(mesh, is_long).run();
}

Eigen::Matrix3Xd with_middles(const Eigen::Matrix3Xd& columns, const Eigen::Matrix2Xi& ends) {
  Eigen::Matrix3Xd result(3, columns.cols() + ends.cols());
  result.leftCols(columns.cols()) = columns;
  for (Eigen::Index i = 0; i < ends.cols(); ++i)
    result.col(columns.cols() + i) = (result.col(ends(0, i)) + result.col(ends(1, i))) / 2;
  return result;
}

}  // namespace palpate::geometry
