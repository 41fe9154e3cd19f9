// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "query/decimation_check.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <numeric>
#include <span>
#include <utility>

#include "base/numbers.h"
#include "mesh/compact_mesh.h"
#include "mesh/edge_table.h"
#include "mesh/same_places.h"
#include "mesh/triangle_primitives.h"
#include "palpate/core/parallel_for.h"

namespace palpate::geometry {
namespace {

/// A triangle is a sliver iff its height is at most this fraction of its longest side; its
/// orientation is then mostly noise.
constexpr double kThin = 1e-2;

/// Slivers may be adjacent to slivers; each pass mends those that do not touch each other.
constexpr int kMostPasses = 12;

/// The longest side of a triangle if it is a sliver, or else none.
int sliver_side(const TriangleMesh& mesh, int triangle) {
  const auto edge = [&mesh, triangle](int k) -> Eigen::Vector3d {
    return mesh.vertices.col(mesh.triangles((k + 1) % 3, triangle)) -
           mesh.vertices.col(mesh.triangles(k, triangle));
  };
  int side = 0;
  for (int k = 1; k < 3; ++k) {
    if (edge(k).squaredNorm() > edge(side).squaredNorm()) side = k;
  }
  const double area = edge(0).cross(edge(1)).norm();
  return area <= kThin * edge(side).squaredNorm() ? 3 * triangle + side : kNone;
}

/// The triangles that share a vertex with one of `some`, without those to be dropped.
std::vector<bool> triangles_around(const TriangleMesh& mesh, const std::vector<int>& some,
                                   const std::vector<char>& drop) {
  std::vector<char> at_corner(static_cast<std::size_t>(mesh.vertices.cols()), 0);
  for (const int t : some) {
    for (const int v : mesh.triangles.col(t)) at_corner[static_cast<std::size_t>(v)] = 1;
  }
  std::vector<bool> around(drop.size(), false);
  for (std::size_t t = 0; t < drop.size(); ++t) {
    if (drop[t] != 0) continue;
    for (const int v : mesh.triangles.col(static_cast<Eigen::Index>(t)))
      around[t] = around[t] || at_corner[static_cast<std::size_t>(v)] != 0;
  }
  return around;
}

/// Removes a sliver at the border, or gives its middle corner to the neighbour across its longest
/// edge. This moves the surface by at most the sliver's height. False if it cannot be done in this
/// pass.
bool mend(TriangleMesh& mesh, int half_edge, int other, const auto& edge_exists,
          const std::vector<char>& fixed, const std::vector<char>& at_seam,
          std::vector<char>& touched, std::vector<char>& drop) {
  const int sliver = half_edge / 3;
  const int a = mesh.triangles(half_edge % 3, sliver);
  const int c = mesh.triangles((half_edge + 1) % 3, sliver);
  const int b = mesh.triangles((half_edge + 2) % 3, sliver);
  const auto is_fixed = [&fixed](int v) { return fixed[static_cast<std::size_t>(v)] != 0; };
  if (is_fixed(a) && is_fixed(b) && is_fixed(c)) return false;
  if (other == kNone && at_seam[static_cast<std::size_t>(a)] != 0 &&
      at_seam[static_cast<std::size_t>(c)] != 0)
    return false;
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

/// Returns true if a triangle faces the other way than the input below it, at its centre and
/// half-way to each corner. All of these are required, because across a steep step of the input the
/// nearest triangle may be an upright one.
bool turned_over(const TriangleMesh& candidate, int triangle, const DecimationStandard& standard) {
  const Eigen::Vector3d normal =
      area_vector(candidate.vertices, candidate.triangles.col(triangle)).stableNormalized();
  const Eigen::Vector3d centre = Eigen::Vector3d::Constant(1.0 / 3);
  for (int k = -1; k < 3; ++k) {
    Eigen::Vector3d at = centre;
    if (k >= 0) at = (centre + Eigen::Vector3d::Unit(k)) / 2;
    const Eigen::Vector3d place = position(candidate, {.triangle = triangle, .barycentric = at});
    const int below = standard.input.query.closest_point(place).at.triangle;
    if (below < 0) return true;
    const Eigen::Vector3d of_input = standard.normals.col(below);
    if (!of_input.allFinite() || normal.dot(of_input) >= 0) return false;
  }
  return true;
}

}  // namespace

Gluing gluing(const TriangleMesh& mesh, const std::vector<int>& joined) {
  const Eigen::Matrix3Xi triangles =
      mesh.triangles.unaryExpr([&](int v) { return joined[static_cast<std::size_t>(v)]; });
  Gluing found{.bad_edge = std::vector<char>(static_cast<std::size_t>(mesh.triangles.cols()), 0),
               .fans = std::vector<int>(static_cast<std::size_t>(mesh.vertices.cols()), 0)};
  CornerClasses corners(triangles.size());
  for_each_edge(sort_sides(triangles), [&](std::span<const EdgeSide> sides) {
    const bool bad =
        sides.size() > 2 || (sides.size() == 2 && sides[0].upwards == sides[1].upwards);
    for (const EdgeSide& side : sides) {
      if (bad) found.bad_edge[static_cast<std::size_t>(side.triangle())] = 1;
      corners.join(sides.front(), side);
    }
  });
  for (int corner = 0; corner < static_cast<int>(triangles.size()); ++corner) {
    if (corners.find(corner) == corner)
      ++found.fans[static_cast<std::size_t>(triangles.reshaped()[corner])];
  }
  return found;
}

void mend_slivers(TriangleMesh& mesh, const std::vector<char>& fixed,
                  const std::vector<char>& at_seam) {
  std::vector<char> drop(static_cast<std::size_t>(mesh.triangles.cols()), 0);
  std::vector<int> longest(drop.size(), kNone);  // see `sliver_side`
  std::vector<int> slivers;
  for (int t = 0; t < static_cast<int>(drop.size()); ++t) {
    longest[static_cast<std::size_t>(t)] = sliver_side(mesh, t);
    if (longest[static_cast<std::size_t>(t)] != kNone) slivers.push_back(t);
  }
  for (int pass = 0; pass < kMostPasses && !slivers.empty(); ++pass) {
    const std::vector<EdgeSide> sides =
        sort_sides(mesh.triangles, triangles_around(mesh, slivers, drop));
    const auto edge_exists = [&sides](int a, int b) {
      const std::pair<int, int> edge = std::minmax({a, b});
      const auto place = std::lower_bound(
          sides.begin(), sides.end(), edge,
          [](const EdgeSide& s, const auto& e) { return std::pair(s.low, s.high) < e; });
      return place != sides.end() && std::pair(place->low, place->high) == edge;
    };
    std::vector<char> touched(static_cast<std::size_t>(mesh.vertices.cols()), 0);
    std::vector<int> changed;
    for_each_edge(sides, [&](std::span<const EdgeSide> of_edge) {
      const auto sliver = std::ranges::find_if(of_edge, [&](const EdgeSide& s) {
        return longest[static_cast<std::size_t>(s.triangle())] == s.half_edge;
      });
      if (sliver == of_edge.end() || of_edge.size() > 2) return;
      const int other =
          of_edge.size() == 1 ? kNone : of_edge[sliver == of_edge.begin() ? 1 : 0].half_edge;
      // If the neighbour is a sliver with another longest side, mend that one first. Every other
      // pass ignores this rule, so that two slivers do not wait for each other forever.
      const bool waits = pass % 2 == 0 && other != kNone &&
                         longest[static_cast<std::size_t>(other / 3)] != kNone &&
                         longest[static_cast<std::size_t>(other / 3)] != other;
      if (waits ||
          !mend(mesh, sliver->half_edge, other, edge_exists, fixed, at_seam, touched, drop))
        return;
      changed.push_back(sliver->triangle());
      if (other != kNone) changed.push_back(other / 3);
    });
    if (changed.empty() && pass % 2 == 1) break;
    for (const int t : changed) {
      longest[static_cast<std::size_t>(t)] =
          drop[static_cast<std::size_t>(t)] != 0 ? kNone : sliver_side(mesh, t);
    }
    slivers.insert(slivers.end(), changed.begin(), changed.end());
    std::erase_if(slivers, [&](int t) { return longest[static_cast<std::size_t>(t)] == kNone; });
  }
  Eigen::Index kept = 0;
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    if (drop[static_cast<std::size_t>(t)] == 0) mesh.triangles.col(kept++) = mesh.triangles.col(t);
  }
  mesh.triangles.conservativeResize(3, kept);
}

DecimationStandard::DecimationStandard(const TriangleMesh& mesh, const SeamedMesh* seamed)
    : input(mesh), normals(triangle_normals(mesh)) {
  const std::vector<int> places = first_at_same_place(mesh.vertices);
  at_seam.assign(places.size(), 0);
  joined.resize(places.size());
  std::iota(joined.begin(), joined.end(), 0);
  for (int v = 0; v < static_cast<int>(places.size()); ++v) {
    const int first = places[static_cast<std::size_t>(v)];
    if (first != v)
      at_seam[static_cast<std::size_t>(v)] = at_seam[static_cast<std::size_t>(first)] = 1;
    // The vertices that were split from one are beside each other.
    if (seamed != nullptr && v > 0 &&
        seamed->source[static_cast<std::size_t>(v)] ==
            seamed->source[static_cast<std::size_t>(v) - 1])
      joined[static_cast<std::size_t>(v)] = joined[static_cast<std::size_t>(v) - 1];
  }
  input_gluing = gluing(mesh, joined);
  manifold_edges = std::ranges::count(input_gluing.bad_edge, 1) == 0;
  if (seamed != nullptr) texture.emplace(*seamed);
}

const DistanceTarget& Candidate::target() {
  if (!target_) target_.emplace(compact(mesh_).mesh);
  return *target_;
}

KnownTriangles::KnownTriangles(const TriangleMesh& input)
    : newest_(static_cast<std::size_t>(input.vertices.cols()), kNone) {
  enter(input);
  std::ranges::fill(facts_, Facts{.lie = Lie::right, .near = true});
  for (const int entry : present_) cover_.push_back({.triangles = {entry}, .count = 1});
}

int KnownTriangles::enter(const Eigen::Vector3i& corners) {
  int lowest = 0;
  corners.minCoeff(&lowest);
  const std::array<int, 2> others = {corners[(lowest + 1) % 3], corners[(lowest + 2) % 3]};
  int& newest = newest_[static_cast<std::size_t>(corners[lowest])];
  int entry = newest;
  while (entry != kNone && entries_[static_cast<std::size_t>(entry)].others != others)
    entry = entries_[static_cast<std::size_t>(entry)].next;
  if (entry != kNone) return entry;
  entry = static_cast<int>(entries_.size());
  entries_.push_back({.others = others, .next = newest});
  facts_.emplace_back();
  last_seen_.push_back(candidate_);
  newest = entry;
  return entry;
}

void KnownTriangles::enter(const TriangleMesh& candidate) {
  ++candidate_;
  present_.clear();
  for (const auto& corners : candidate.triangles.colwise()) {
    present_.push_back(enter(Eigen::Vector3i(corners)));
    last_seen_[static_cast<std::size_t>(present_.back())] = candidate_;
  }
}

bool KnownTriangles::is_covered(std::size_t input_triangle) const {
  const Witnesses& witnesses = cover_[input_triangle];
  return witnesses.is_complete() && std::ranges::all_of(witnesses.all(), [&](int entry) {
           return last_seen_[static_cast<std::size_t>(entry)] == candidate_;
         });
}

void KnownTriangles::set_covered(std::size_t input_triangle, const Witnesses& witnesses) {
  Witnesses& cover = cover_[input_triangle];
  cover.count = witnesses.count;
  std::ranges::transform(witnesses.triangles, cover.triangles.begin(), [&](int triangle) {
    return present_[static_cast<std::size_t>(triangle)];
  });
}

namespace {

/// Triangles of the candidate that are badly connected, or lie wrong.
std::vector<int> bad_shapes(const TriangleMesh& candidate, const DecimationStandard& standard,
                            double tolerance, KnownTriangles& known) {
  using Lie = KnownTriangles::Lie;
  const auto count = static_cast<std::size_t>(candidate.triangles.cols());
  std::vector<int> open;
  for (std::size_t t = 0; t < count; ++t) {
    Lie& lie = known.facts(t).lie;
    if (lie != Lie::unknown) continue;
    lie = Lie::right;  // until it is judged below
    open.push_back(static_cast<int>(t));
  }
  std::vector<char> is_wrong(open.size(), 0);
  parallel_for(open.size(), [&](std::size_t i) {
    is_wrong[i] =
        (sliver_side(candidate, open[i]) == kNone && turned_over(candidate, open[i], standard)) ||
        (standard.texture && standard.texture->slips(candidate, open[i], tolerance));
  });
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (is_wrong[i] != 0) known.facts(static_cast<std::size_t>(open[i])).lie = Lie::wrong;
  }
  const Gluing glued = gluing(candidate, standard.joined);
  std::vector<int> found;
  for (std::size_t t = 0; t < count; ++t) {
    bool bad =
        known.facts(t).lie == Lie::wrong || (standard.manifold_edges && glued.bad_edge[t] != 0);
    for (const int v : candidate.triangles.col(static_cast<Eigen::Index>(t))) {
      const auto vertex = static_cast<std::size_t>(standard.joined[static_cast<std::size_t>(v)]);
      bad = bad || glued.fans[vertex] > standard.input_gluing.fans[vertex];
    }
    if (bad) found.push_back(static_cast<int>(t));
  }
  return found;
}

/// Looks for points of the input that are too far from the candidate.
void find_lost(Candidate& candidate, const DecimationStandard& standard, const BoundGoal& goal,
               KnownTriangles& known, Unfit& unfit) {
  std::vector<int> open;
  for (int t = 0; t < static_cast<int>(standard.input.mesh.triangles.cols()); ++t) {
    if (!known.is_covered(static_cast<std::size_t>(t))) open.push_back(t);
  }
  if (open.empty()) return;
  const std::vector<TriangleBound> bounds =
      bound_triangle_distances(standard.input.mesh, open, candidate.target(), goal);
  for (std::size_t i = 0; i < open.size(); ++i) {
    const auto& [found, witnesses] = bounds[i];
    if (found.upper <= goal.stop_above) {
      known.set_covered(static_cast<std::size_t>(open[i]), witnesses);
    } else {
      unfit.far.push_back(candidate.target().query.closest_point(found.at).at.triangle);
      unfit.lost.push_back(found.at);
    }
  }
  std::sort(unfit.far.begin(), unfit.far.end());
  unfit.far.erase(std::unique(unfit.far.begin(), unfit.far.end()), unfit.far.end());
}

/// Looks for triangles of the candidate with points that are too far from the input.
void find_far(const TriangleMesh& candidate, const DecimationStandard& standard,
              const BoundGoal& goal, KnownTriangles& known, Unfit& unfit) {
  std::vector<int> open;
  for (int t = 0; t < static_cast<int>(candidate.triangles.cols()); ++t) {
    if (!known.facts(static_cast<std::size_t>(t)).near) open.push_back(t);
  }
  const std::vector<TriangleBound> bounds =
      bound_triangle_distances(candidate, open, standard.input, goal);
  for (std::size_t i = 0; i < open.size(); ++i) {
    if (bounds[i].largest.upper <= goal.stop_above)
      known.facts(static_cast<std::size_t>(open[i])).near = true;
    else
      unfit.far.push_back(open[i]);
  }
}

}  // namespace

Unfit find_unfit(Candidate& candidate, const DecimationStandard& standard, double tolerance,
                 KnownTriangles& known) {
  known.enter(candidate.mesh());
  Unfit unfit;
  unfit.shapes = bad_shapes(candidate.mesh(), standard, tolerance, known);
  if (unfit.count() > 0 || !(tolerance < kInfinity)) return unfit;
  const BoundGoal goal{.ignore_below = tolerance, .stop_above = tolerance};
  find_lost(candidate, standard, goal, known, unfit);
  if (unfit.count() == 0) find_far(candidate.mesh(), standard, goal, known, unfit);
  return unfit;
}

}  // namespace palpate::geometry
