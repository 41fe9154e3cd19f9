// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_repair.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <utility>

#include "mesh/edge_table.h"
#include "mesh/same_places.h"
#include "mesh/triangle_primitives.h"
#include "palpate/core/error.h"
#include "palpate/core/work_steps.h"

namespace palpate::geometry {
namespace {

/// A round of flips can replace flat triangles by as many others. After this many such rounds in a
/// row the remaining flat triangles are folded onto themselves.
constexpr int kIdleRounds = 16;

/// Parts of the work in `Repair::run`.
constexpr int kParts = 7;

using Pair = std::pair<EdgeSide, EdgeSide>;

class Repair {
 public:
  Repair(const TriangleMesh& mesh, const RepairOptions& options)
      : steps_(options.progress, kParts),
        input_(mesh),
        triangles_(mesh.triangles),
        use_(count(mesh), true),
        place_(first_at_same_place(mesh.vertices)) {}

  RepairedMesh run() {
    drop_broken_corners();
    steps_.tell();
    flip_flat();
    steps_.tell();
    drop_repeated();
    steps_.tell();
    const std::vector<EdgeSide> sides = sort_sides(triangles_, use_);
    std::vector<Pair> pairs = pair_sides_of_two(sides);
    turn(pairs);
    steps_.tell();
    const std::size_t of_two = pairs.size();
    pair_sides_of_more(sides, pairs);
    steps_.tell();
    if (pairs.size() > of_two) turn(pairs);
    for (const bool turned : turned_) result_.turned_triangles += turned;
    steps_.tell();
    rebuild(pairs);
    steps_.end();
    return std::move(result_);
  }

 private:
  static size_t count(const TriangleMesh& mesh) {
    return static_cast<size_t>(mesh.triangles.cols());
  }

  void drop(int t) {
    use_[static_cast<size_t>(t)] = false;
    ++result_.removed_triangles;
  }

  [[nodiscard]] Eigen::Vector3d at(int vertex) const { return input_.vertices.col(vertex); }

  void drop_broken_corners() {
    for (int t = 0; t < triangles_.cols(); ++t) {
      auto corners = triangles_.col(t);
      const bool sound = corners.minCoeff() >= 0 && corners.maxCoeff() < input_.vertices.cols() &&
                         input_.vertices(Eigen::all, corners).allFinite();
      if (sound) {
        for (int& corner : corners) corner = place_[static_cast<size_t>(corner)];
      }
      if (!sound || corners[0] == corners[1] || corners[1] == corners[2] ||
          corners[2] == corners[0]) {
        drop(t);
      }
    }
  }

  /// Removes triangles without area whose vertices are collinear. Each gives its middle vertex to
  /// the neighbour across its longest side, or is dropped if there is none. In a chain of such
  /// triangles each round handles one at an end.
  void flip_flat() {
    std::vector<int> all(use_.size());
    std::iota(all.begin(), all.end(), 0);
    std::vector<int> flat = find_flat(all);
    size_t fewest = flat.size();
    for (int idle = 0; !flat.empty() && idle < kIdleRounds;) {
      const std::vector<int> changed = flip_once(flat);
      steps_.tell(0);
      if (changed.empty()) return;
      std::vector<bool> is_changed(use_.size());
      for (const int t : changed) is_changed[static_cast<size_t>(t)] = true;
      std::erase_if(flat, [&](int t) { return is_changed[static_cast<size_t>(t)]; });
      const std::vector<int> again = find_flat(changed);
      flat.insert(flat.end(), again.begin(), again.end());
      idle = flat.size() < fewest ? 0 : idle + 1;
      fewest = std::min(fewest, flat.size());
    }
  }

  /// One round: flips that do not touch each other. Returns the triangles changed.
  std::vector<int> flip_once(const std::vector<int>& flat) {
    std::vector<bool> is_flat(use_.size());
    for (const int t : flat) is_flat[static_cast<size_t>(t)] = true;
    std::vector<bool> touched(use_.size());
    std::vector<int> changed;
    const auto touch = [&](int t) {
      touched[static_cast<size_t>(t)] = true;
      changed.push_back(t);
    };
    for_each_edge(sort_sides(triangles_, around(flat)), [&](std::span<const EdgeSide> sides) {
      for (const EdgeSide& side : sides) {
        const int t = side.triangle();
        if (!is_flat[static_cast<size_t>(t)] || touched[static_cast<size_t>(t)] ||
            !is_longest(side)) {
          continue;
        }
        const auto other = std::find_if(sides.begin(), sides.end(), [&](const EdgeSide& s) {
          return !is_flat[static_cast<size_t>(s.triangle())] &&
                 !touched[static_cast<size_t>(s.triangle())];
        });
        if (other != sides.end()) {
          flip(side, *other);
          touch(t);
          touch(other->triangle());
        } else if (sides.size() == 1) {
          drop(t);
          touch(t);
        }
      }
    });
    return changed;
  }

  /// The triangles in use that share a vertex with one of these triangles.
  [[nodiscard]] std::vector<bool> around(const std::vector<int>& triangles) const {
    std::vector<bool> at_vertex(place_.size());
    for (const int t : triangles) {
      for (const int v : triangles_.col(t)) at_vertex[static_cast<size_t>(v)] = true;
    }
    std::vector<bool> near = use_;
    for (int t = 0; t < triangles_.cols(); ++t) {
      if (!use_[static_cast<size_t>(t)]) continue;
      const auto corners = triangles_.col(t);
      near[static_cast<size_t>(t)] = std::any_of(
          corners.begin(), corners.end(), [&](int v) { return at_vertex[static_cast<size_t>(v)]; });
    }
    return near;
  }

  /// The triangles in use, among these, that have no area.
  [[nodiscard]] std::vector<int> find_flat(std::vector<int> triangles) const {
    std::erase_if(triangles, [&](int t) { return !use_[static_cast<size_t>(t)]; });
    TriangleMesh used;
    used.vertices = input_.vertices(Eigen::all, triangles_(Eigen::all, triangles).reshaped());
    used.triangles = Eigen::VectorXi::LinSpaced(static_cast<Eigen::Index>(3 * triangles.size()), 0,
                                                static_cast<int>(3 * triangles.size()) - 1)
                         .reshaped(3, static_cast<Eigen::Index>(triangles.size()));
    const Eigen::Matrix3Xd normals = triangle_normals(used);
    std::vector<int> flat;
    for (size_t i = 0; i < triangles.size(); ++i) {
      if (!normals.col(static_cast<Eigen::Index>(i)).allFinite()) flat.push_back(triangles[i]);
    }
    return flat;
  }

  [[nodiscard]] bool is_longest(const EdgeSide& side) const {
    const double length = (at(side.high) - at(side.low)).stableNorm();  // its square may overflow
    const Eigen::Vector3d apex = at(apex_of(side));
    return length > (apex - at(side.low)).stableNorm() &&
           length > (apex - at(side.high)).stableNorm();
  }

  [[nodiscard]] int apex_of(const EdgeSide& side) const {
    return triangles_((side.half_edge + 2) % 3, side.triangle());
  }

  /// Exchanges the diagonal of the quadrilateral of two triangles; both get the orientation of
  /// `other`.
  void flip(const EdgeSide& flat, const EdgeSide& other) {
    const int from = triangles_(other.half_edge % 3, other.triangle());
    const int to = triangles_((other.half_edge + 1) % 3, other.triangle());
    const int apex = apex_of(other);
    const int middle = apex_of(flat);
    triangles_.col(other.triangle()) << from, middle, apex;
    triangles_.col(flat.triangle()) << middle, to, apex;
    ++result_.flipped_edges;
  }

  void drop_repeated() {
    for (int t = 0; t < triangles_.cols(); ++t) {
      const auto corners = triangles_.col(t);
      if (use_[static_cast<size_t>(t)] &&
          (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0])) {
        drop(t);
      }
    }
    for (const int t : repeated_triangles(triangles_, use_)) drop(t);
  }

  /// Direction from the edge into the triangle, perpendicular to the edge.
  [[nodiscard]] Eigen::Vector3d into_triangle(const EdgeSide& side) const {
    const Eigen::Vector3d along = (at(side.high) - at(side.low)).stableNormalized();
    const Eigen::Vector3d to_apex = at(apex_of(side)) - at(side.low);
    return (to_apex - along.dot(to_apex) * along).stableNormalized();
  }

  /// Joins the two sides of the edges that have just two.
  static std::vector<Pair> pair_sides_of_two(const std::vector<EdgeSide>& all) {
    std::vector<Pair> pairs;
    for_each_edge(all, [&](std::span<const EdgeSide> sides) {
      if (sides.size() == 2) pairs.emplace_back(sides[0], sides[1]);
    });
    return pairs;
  }

  /// Decides which sides are joined where more than two meet: first those whose triangles face the
  /// same side of a surface, as each of two solids that touch along an edge keeps its own, and
  /// among them those with the flattest angle.
  void pair_sides_of_more(const std::vector<EdgeSide>& all, std::vector<Pair>& pairs) {
    for_each_edge(all, [&](std::span<const EdgeSide> sides) {
      if (sides.size() <= 2) return;
      ++result_.cut_edges;
      std::vector<EdgeSide> left(sides.begin(), sides.end());
      while (left.size() >= 2) {
        std::pair<size_t, size_t> best = {0, 1};
        std::pair<bool, double> least = {true, std::numeric_limits<double>::infinity()};
        for (size_t i = 0; i < left.size(); ++i) {
          for (size_t j = i + 1; j < left.size(); ++j) {
            const std::pair<bool, double> cost = {
                runs_upwards(left[i]) == runs_upwards(left[j]),
                into_triangle(left[i]).dot(into_triangle(left[j]))};
            if (cost < least) {
              least = cost;
              best = {i, j};
            }
          }
        }
        pairs.emplace_back(left[best.first], left[best.second]);
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(best.second));
        left.erase(left.begin() + static_cast<std::ptrdiff_t>(best.first));
      }
    });
  }

  /// Reverses the smaller area of each connected surface, so that joined triangles agree.
  void turn(const std::vector<Pair>& pairs) {
    struct Neighbor {
      int triangle = -1;  // none
      bool against = false;
    };
    std::vector<std::array<Neighbor, 3>> neighbors(use_.size());
    const auto add = [&](const EdgeSide& of, const Neighbor& neighbor) {
      auto& all = neighbors[static_cast<size_t>(of.triangle())];
      *std::ranges::find(all, -1, &Neighbor::triangle) = neighbor;
    };
    for (const auto& [a, b] : pairs) {
      const bool against = a.upwards == b.upwards;
      add(a, {b.triangle(), against});
      add(b, {a.triangle(), against});
    }
    turned_.assign(use_.size(), false);
    std::vector<bool> seen(use_.size());
    for (int seed = 0; seed < triangles_.cols(); ++seed) {
      if (!use_[static_cast<size_t>(seed)] || seen[static_cast<size_t>(seed)]) continue;
      std::vector<int> surface = {seed};
      seen[static_cast<size_t>(seed)] = true;
      double excess = 0;  // [mm^2] area oriented like the seed minus the rest
      for (size_t i = 0; i < surface.size(); ++i) {
        const auto t = static_cast<size_t>(surface[i]);
        excess +=
            (turned_[t] ? -1 : 1) * area_vector(input_.vertices, triangles_.col(surface[i])).norm();
        for (const auto& [next, against] : neighbors[t]) {
          if (next < 0 || seen[static_cast<size_t>(next)]) continue;
          seen[static_cast<size_t>(next)] = true;
          turned_[static_cast<size_t>(next)] = turned_[t] != against;
          surface.push_back(next);
        }
      }
      if (excess >= 0) continue;
      for (const int t : surface)
        turned_[static_cast<size_t>(t)] = !turned_[static_cast<size_t>(t)];
    }
  }

  [[nodiscard]] bool runs_upwards(const EdgeSide& side) const {
    return side.upwards != turned_[static_cast<size_t>(side.triangle())];
  }

  /// Joins the triangles of each pair. A triangle that meets others at an edge although it is not
  /// joined to them there, because their fans are joined at both ends of the edge, is cut free.
  CornerClasses join(std::vector<Pair> pairs) {
    const auto cut = [&](const auto& is_cut) {
      result_.cut_edges += static_cast<int>(std::erase_if(pairs, is_cut));
    };
    cut([&](const Pair& pair) {  // of a one-sided surface
      return runs_upwards(pair.first) == runs_upwards(pair.second);
    });
    while (true) {
      CornerClasses fans(triangles_.size());
      for (const auto& [a, b] : pairs) fans.join(a, b);
      const std::vector<bool> is_free = excess_at_edges(fans, pairs);
      if (std::ranges::find(is_free, true) == is_free.end()) return fans;
      // Each free triangle is in a pair, or its fans would be its own. So every round removes
      // pairs, and the loop ends.
      cut([&](const Pair& pair) {
        return is_free[static_cast<size_t>(pair.first.triangle())] ||
               is_free[static_cast<size_t>(pair.second.triangle())];
      });
    }
  }

  /// The triangles at edges between two fans, beyond the two that form the surface there.
  std::vector<bool> excess_at_edges(CornerClasses& fans, const std::vector<Pair>& pairs) const {
    Eigen::Matrix3Xi fan_of(3, triangles_.cols());
    for (int corner = 0; corner < triangles_.size(); ++corner)
      fan_of(corner % 3, corner / 3) = fans.find(corner);
    std::vector<int> partner(static_cast<size_t>(triangles_.size()), -1);
    for (const auto& [a, b] : pairs) {
      partner[static_cast<size_t>(a.half_edge)] = b.half_edge;
      partner[static_cast<size_t>(b.half_edge)] = a.half_edge;
    }
    std::vector<bool> excess(use_.size());
    for_each_edge(sort_sides(fan_of, use_), [&](std::span<const EdgeSide> sides) {
      if (sides.size() == 1 ||
          (sides.size() == 2 && runs_upwards(sides[0]) != runs_upwards(sides[1]))) {
        return;
      }
      const auto partner_of = [&](const EdgeSide& side) {
        return partner[static_cast<size_t>(side.half_edge)];
      };
      const auto joined =
          std::ranges::find_if(sides, [&](const EdgeSide& side) { return partner_of(side) >= 0; });
      const EdgeSide& kept = joined != sides.end() ? *joined : sides.front();
      for (const EdgeSide& side : sides) {
        if (side.half_edge != kept.half_edge && side.half_edge != partner_of(kept))
          excess[static_cast<size_t>(side.triangle())] = true;
      }
    });
    return excess;
  }

  /// Makes one vertex for each fan of joined triangles.
  void rebuild(const std::vector<Pair>& pairs) {
    CornerClasses fans = join(pairs);
    std::vector<std::pair<int, int>> vertices;  // input vertex, fan
    for (int corner = 0; corner < triangles_.size(); ++corner) {
      if (use_[static_cast<size_t>(corner / 3)] && fans.find(corner) == corner)
        vertices.emplace_back(triangles_(corner % 3, corner / 3), corner);
    }
    if (vertices.empty())
      throw InvalidInput("mesh: no triangle can be kept: each is defective or without area");
    std::sort(vertices.begin(), vertices.end());
    std::vector<int> index_of_fan(static_cast<size_t>(triangles_.size()), -1);
    result_.mesh.vertices.resize(3, static_cast<Eigen::Index>(vertices.size()));
    for (size_t v = 0; v < vertices.size(); ++v) {
      index_of_fan[static_cast<size_t>(vertices[v].second)] = static_cast<int>(v);
      result_.mesh.vertices.col(static_cast<Eigen::Index>(v)) = at(vertices[v].first);
      result_.source.push_back(vertices[v].first);
    }
    Eigen::Index kept = 0;
    result_.mesh.triangles.resize(3, triangles_.cols() - result_.removed_triangles);
    for (int t = 0; t < triangles_.cols(); ++t) {
      if (!use_[static_cast<size_t>(t)]) continue;
      auto corners = result_.mesh.triangles.col(kept++);
      for (int k = 0; k < 3; ++k)
        corners[k] = index_of_fan[static_cast<size_t>(fans.find(3 * t + k))];
      if (turned_[static_cast<size_t>(t)]) std::swap(corners[1], corners[2]);
    }
    count_vertices();
  }

  void count_vertices() {
    std::vector<bool> kept(place_.size());
    for (const int v : result_.source) {
      if (kept[static_cast<size_t>(v)]) ++result_.split_vertices;
      kept[static_cast<size_t>(v)] = true;
    }
    for (size_t v = 0; v < place_.size(); ++v) {
      if (place_[v] != static_cast<int>(v)) {
        ++result_.welded_vertices;
      } else if (!kept[v]) {
        ++result_.removed_vertices;
      }
    }
  }

  WorkSteps steps_;
  const TriangleMesh& input_;
  Eigen::Matrix3Xi triangles_;
  std::vector<bool> use_;
  std::vector<int> place_;  ///< for each vertex, the first one at the same place
  std::vector<bool> turned_;
  RepairedMesh result_;
};

}  // namespace

RepairedMesh repair_mesh(const TriangleMesh& mesh, const RepairOptions& options) {
  return Repair(mesh, options).run();
}

}  // namespace palpate::geometry
