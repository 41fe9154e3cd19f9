// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "query/decimation_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "base/numbers.h"
#include "palpate/parallel_for.h"

namespace palpate::geometry {
namespace {

/// One side of a triangle, its edge as the pair of its vertices in ascending order.
struct Side {
  std::pair<int, int> edge;
  int half_edge;
};

int next_in_triangle(int half_edge) { return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1; }

int root(std::vector<int>& parent, int i) {
  while (parent[static_cast<std::size_t>(i)] != i) {
    parent[static_cast<std::size_t>(i)] =
        parent[static_cast<std::size_t>(parent[static_cast<std::size_t>(i)])];
    i = parent[static_cast<std::size_t>(i)];
  }
  return i;
}

std::vector<Side> sorted_sides(const TriangleMesh& mesh) {
  std::vector<Side> sides(static_cast<std::size_t>(mesh.triangles.size()));
  for (int h = 0; h < static_cast<int>(sides.size()); ++h) {
    sides[static_cast<std::size_t>(h)] = {
        .edge = std::minmax({mesh.triangles(h % 3, h / 3), mesh.triangles((h + 1) % 3, h / 3)}),
        .half_edge = h};
  }
  std::sort(sides.begin(), sides.end(), [](const Side& one, const Side& other) {
    return std::pair(one.edge, one.half_edge) < std::pair(other.edge, other.half_edge);
  });
  return sides;
}

/// A triangle is a sliver iff its height is at most this fraction of its longest side; its
/// orientation is then mostly noise.
constexpr double kThin = 1e-2;

/// Slivers may be adjacent to slivers; each pass mends those that do not touch each other.
constexpr int kMostPasses = 12;

/// The longest side of a triangle that is a sliver; none for others.
std::vector<int> sliver_sides(const TriangleMesh& mesh) {
  std::vector<int> longest(static_cast<std::size_t>(mesh.triangles.cols()), kNone);
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    const auto edge = [&mesh, t](int k) -> Eigen::Vector3d {
      return mesh.vertices.col(mesh.triangles((k + 1) % 3, t)) -
             mesh.vertices.col(mesh.triangles(k, t));
    };
    int side = 0;
    for (int k = 1; k < 3; ++k) {
      if (edge(k).squaredNorm() > edge(side).squaredNorm()) side = k;
    }
    const double area = edge(0).cross(edge(1)).norm();
    if (area <= kThin * edge(side).squaredNorm()) {
      longest[static_cast<std::size_t>(t)] = 3 * static_cast<int>(t) + side;
    }
  }
  return longest;
}

/// Removes a sliver at the border, or gives its middle corner to the neighbour across its longest
/// edge. This moves the surface by at most the sliver's height. False if it cannot be done in this
/// pass.
bool mend(TriangleMesh& mesh, int half_edge, int other, const auto& edge_exists,
          const std::vector<char>& fixed, std::vector<char>& touched, std::vector<char>& drop) {
  const int sliver = half_edge / 3;
  const int a = mesh.triangles(half_edge % 3, sliver);
  const int c = mesh.triangles((half_edge + 1) % 3, sliver);
  const int b = mesh.triangles((half_edge + 2) % 3, sliver);
  const auto is_fixed = [&fixed](int v) { return fixed[static_cast<std::size_t>(v)] != 0; };
  if (is_fixed(a) && is_fixed(b) && is_fixed(c)) return false;
  const int d = other == kNone ? b : mesh.triangles((other + 2) % 3, other / 3);
  for (const int v : {a, b, c, d}) {
    if (touched[static_cast<std::size_t>(v)] != 0) return false;
  }
  if (drop[static_cast<std::size_t>(sliver)] != 0) return false;
  if (other == kNone) {
    drop[static_cast<std::size_t>(sliver)] = 1;
    // Exclude it from the rest of this pass.
    mesh.triangles.col(sliver).setConstant(a);
  } else {
    if (d == b || mesh.triangles(other % 3, other / 3) != c || edge_exists(b, d)) return false;
    mesh.triangles.col(sliver) << a, d, b;
    mesh.triangles.col(other / 3) << d, c, b;
  }
  for (const int v : {a, b, c, d}) touched[static_cast<std::size_t>(v)] = 1;
  return true;
}

/// The corners, rotated so that the smallest comes first, which identifies a triangle.
std::array<int, 3> turned_corners(const TriangleMesh& mesh, Eigen::Index triangle) {
  const Eigen::Vector3i of = mesh.triangles.col(triangle);
  std::array<int, 3> corners = {of[0], of[1], of[2]};
  std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
  return corners;
}

/// Whether a new triangle faces the other way than the input below it, at its centre and half-way
/// to each corner. All of these are required, because across a steep step of the input the nearest
/// triangle may be an upright one.
bool turned_over(const TriangleMesh& candidate, Eigen::Index triangle,
                 const Eigen::Vector3d& normal, const DecimationStandard& standard) {
  if (std::binary_search(standard.triangles.begin(), standard.triangles.end(),
                         turned_corners(candidate, triangle))) {
    return false;
  }
  const Eigen::Vector3d centre = Eigen::Vector3d::Constant(1.0 / 3);
  for (int k = -1; k < 3; ++k) {
    Eigen::Vector3d at = centre;
    if (k >= 0) at = (centre + Eigen::Vector3d::Unit(k)) / 2;
    const Eigen::Vector3d place =
        position(candidate, {.triangle = static_cast<int>(triangle), .barycentric = at});
    const int below = standard.input.query.closest_point(place).at.triangle;
    if (below < 0) return true;
    const Eigen::Vector3d of_input = standard.normals.col(below);
    if (!of_input.allFinite() || normal.dot(of_input) >= 0) return false;
  }
  return true;
}

}  // namespace

Gluing gluing(const TriangleMesh& mesh) {
  Gluing found{.bad_edge = std::vector<char>(static_cast<std::size_t>(mesh.triangles.cols()), 0),
               .fans = std::vector<int>(static_cast<std::size_t>(mesh.vertices.cols()), 0)};
  // Corners, named by their outgoing half-edge, are joined where their triangles share an edge.
  std::vector<int> parent(static_cast<std::size_t>(mesh.triangles.size()));
  std::iota(parent.begin(), parent.end(), 0);
  const auto from = [&](int h) { return mesh.triangles(h % 3, h / 3); };
  const auto join = [&](int a, int b) {
    parent[static_cast<std::size_t>(root(parent, a))] = root(parent, b);
  };
  const std::vector<Side> sides = sorted_sides(mesh);
  for (auto first = sides.begin(); first != sides.end();) {
    const auto last =
        std::find_if(first, sides.end(), [&](const Side& s) { return s.edge != first->edge; });
    const bool bad = last - first > 2 ||
                     (last - first == 2 && from(first->half_edge) == from((first + 1)->half_edge));
    for (auto side = first; side != last; ++side) {
      if (bad) found.bad_edge[static_cast<std::size_t>(side->half_edge / 3)] = 1;
      const int one = first->half_edge;
      const int other = side->half_edge;
      const bool along = from(one) == from(other);
      join(one, along ? other : next_in_triangle(other));
      join(next_in_triangle(one), along ? next_in_triangle(other) : other);
    }
    first = last;
  }
  for (int h = 0; h < static_cast<int>(parent.size()); ++h) {
    if (root(parent, h) == h) ++found.fans[static_cast<std::size_t>(from(h))];
  }
  return found;
}

void mend_slivers(TriangleMesh& mesh, const std::vector<char>& fixed) {
  std::vector<char> drop(static_cast<std::size_t>(mesh.triangles.cols()), 0);
  for (int pass = 0; pass < kMostPasses; ++pass) {
    const std::vector<int> longest = sliver_sides(mesh);
    const std::vector<Side> sides = sorted_sides(mesh);
    const auto edge_exists = [&sides](int a, int b) {
      const std::pair<int, int> edge = std::minmax({a, b});
      const auto place = std::lower_bound(sides.begin(), sides.end(), edge,
                                          [](const Side& s, const auto& e) { return s.edge < e; });
      return place != sides.end() && place->edge == edge;
    };
    std::vector<char> touched(static_cast<std::size_t>(mesh.vertices.cols()), 0);
    bool changed = false;
    for (auto first = sides.begin(); first != sides.end();) {
      const auto last =
          std::find_if(first, sides.end(), [&](const Side& s) { return s.edge != first->edge; });
      const auto sliver = std::find_if(first, last, [&](const Side& s) {
        return longest[static_cast<std::size_t>(s.half_edge / 3)] == s.half_edge;
      });
      const auto count = last - first;
      if (sliver != last && count <= 2) {
        const int other = count == 1 ? kNone : (sliver == first ? first + 1 : first)->half_edge;
        // If the neighbour is a sliver with another longest side, mend that one first. Every other
        // pass ignores this rule, so that two slivers do not wait for each other forever.
        const bool waits = pass % 2 == 0 && other != kNone &&
                           longest[static_cast<std::size_t>(other / 3)] != kNone &&
                           longest[static_cast<std::size_t>(other / 3)] != other;
        if (!waits) {
          changed |= mend(mesh, sliver->half_edge, other, edge_exists, fixed, touched, drop);
        }
      }
      first = last;
    }
    if (!changed && pass % 2 == 1) break;
  }
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    if (drop[static_cast<std::size_t>(t)] == 0) mesh.triangles.col(kept++) = mesh.triangles.col(t);
  }
  mesh.triangles.conservativeResize(3, kept);
}

DecimationStandard::DecimationStandard(const TriangleMesh& mesh)
    : input(mesh),
      input_gluing(gluing(mesh)),
      manifold_edges(std::count(input_gluing.bad_edge.begin(), input_gluing.bad_edge.end(), 1) ==
                     0),
      normals(triangle_normals(mesh)) {
  for (Eigen::Index t = 0; t < normals.cols(); ++t) triangles.push_back(turned_corners(mesh, t));
  std::sort(triangles.begin(), triangles.end());
}

namespace {

/// Triangles of the candidate that are badly connected, or flipped without being slivers.
std::vector<int> bad_shapes(const TriangleMesh& candidate, const DecimationStandard& standard) {
  const auto count = static_cast<std::size_t>(candidate.triangles.cols());
  const Eigen::Matrix3Xd normals = triangle_normals(candidate);
  std::vector<char> bad(count, 0);
  const std::vector<int> slivers = sliver_sides(candidate);
  parallel_for(count, [&](std::size_t t) {
    const auto triangle = static_cast<Eigen::Index>(t);
    bad[t] =
        slivers[t] == kNone && turned_over(candidate, triangle, normals.col(triangle), standard);
  });
  const Gluing glued = gluing(candidate);
  std::vector<int> found;
  for (std::size_t t = 0; t < count; ++t) {
    if (standard.manifold_edges && glued.bad_edge[t] != 0) bad[t] = 1;
    for (const int v : candidate.triangles.col(static_cast<Eigen::Index>(t))) {
      const auto vertex = static_cast<std::size_t>(v);
      if (glued.fans[vertex] > standard.input_gluing.fans[vertex]) bad[t] = 1;
    }
    if (bad[t] != 0) found.push_back(static_cast<int>(t));
  }
  return found;
}

}  // namespace

Unfit find_unfit(const TriangleMesh& candidate, const DistanceTarget& candidate_target,
                 const DecimationStandard& standard, double tolerance, KnownNear& known) {
  Unfit unfit;
  unfit.shapes = bad_shapes(candidate, standard);
  if (unfit.count() > 0 || !(tolerance < kInfinity)) return unfit;
  const BoundGoal goal{.ignore_below = tolerance, .stop_above = tolerance};
  for (const LargestDistance& found :
       bound_triangle_distances(standard.input.mesh, candidate_target, goal)) {
    if (found.upper <= tolerance) continue;
    unfit.far.push_back(candidate_target.query.closest_point(found.at).at.triangle);
    unfit.lost.push_back(found.at);
  }
  if (unfit.count() > 0) {
    std::sort(unfit.far.begin(), unfit.far.end());
    unfit.far.erase(std::unique(unfit.far.begin(), unfit.far.end()), unfit.far.end());
    return unfit;
  }
  // A triangle near the input stays near; for most triangles this is known from earlier candidates.
  std::vector<int> unknown;
  for (Eigen::Index t = 0; t < candidate.triangles.cols(); ++t) {
    if (!std::binary_search(known.near.begin(), known.near.end(), turned_corners(candidate, t)))
      unknown.push_back(static_cast<int>(t));
  }
  if (unknown.empty()) return unfit;
  const TriangleMesh part{candidate.vertices, candidate.triangles(Eigen::all, unknown)};
  const std::vector<LargestDistance> to_input =
      bound_triangle_distances(part, standard.input, goal);
  const auto before = static_cast<std::ptrdiff_t>(known.near.size());
  for (std::size_t i = 0; i < unknown.size(); ++i) {
    if (to_input[i].upper <= tolerance)
      known.near.push_back(turned_corners(candidate, unknown[i]));
    else
      unfit.far.push_back(unknown[i]);
  }
  std::sort(known.near.begin() + before, known.near.end());
  std::inplace_merge(known.near.begin(), known.near.begin() + before, known.near.end());
  return unfit;
}

}  // namespace palpate::geometry
