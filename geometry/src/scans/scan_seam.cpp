// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/scan_seam.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {
namespace {

using Eigen::Vector3d;
using Edge = std::pair<int, int>;

/// Longest edges of a seam, in spacings of the end with the larger spacing. A gap arises where
/// triangles with a corner on the other side were removed: it is up to two edges wide, of varying
/// length.
constexpr double kLongestAcross = 3;
constexpr double kLongestAlong = 2.5;  ///< between vertices of one piece

/// Number of edges of a face that is always filled, and of one that is filled if at least a third
/// of its corners were exposed by a cut; others are holes in the measurement.
constexpr std::size_t kSmallFace = 8;
constexpr std::size_t kLargestFace = 12;

/// Largest index of a grid; farther points use it too, so that outliers have an index.
constexpr double kFarCell = 1e9;

/// A free sector at a border vertex: its neighbours counter-clockwise from the incoming border
/// edge, over the edges of the seam, to the outgoing border edge.
using Sector = std::vector<int>;

struct Candidate {
  double squared_length;
  Edge edge;
  [[nodiscard]] auto key() const { return std::tuple(squared_length, edge); }
};

class SeamTriangulation {
 public:
  SeamTriangulation(const TriangleMesh& mesh, const Seam& seam)
      : vertices_(mesh.vertices), seam_(seam) {
    collect_border(mesh);
  }

  Eigen::Matrix3Xi run() {
    for (const Candidate& candidate : candidates()) add_if_free(candidate.edge);
    collect_triangles();
    Eigen::Matrix3Xi result(3, static_cast<Eigen::Index>(triangles_.size()));
    for (std::size_t t = 0; t < triangles_.size(); ++t) {
      result.col(static_cast<Eigen::Index>(t)) = triangles_[t];
    }
    return result;
  }

 private:
  [[nodiscard]] Vector3d at(int vertex) const { return vertices_.col(vertex); }
  [[nodiscard]] Vector3d normal(int vertex) const { return seam_.normals.col(vertex); }

  void collect_border(const TriangleMesh& mesh) {
    const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
    const auto next = [](int h) { return h % 3 == 2 ? h - 2 : h + 1; };
    const auto start = [&](int h) { return mesh.triangles(h % 3, h / 3); };
    for (int h = 0; h < opposite.size(); ++h) {
      if (opposite(h % 3, h / 3) >= 0) continue;
      // The border half-edge that follows h around the free sector at its end.
      int out = next(h);
      while (opposite(out % 3, out / 3) >= 0) out = next(opposite(out % 3, out / 3));
      const int vertex = start(next(h));
      sectors_[vertex].push_back({start(h), start(next(out))});
    }
    for (auto& [vertex, sectors] : sectors_) {
      if (sectors.size() > 1 && joinable(vertex)) part(vertex, sectors);
    }
    // Edges that exist already, of all triangles at border vertices.
    for (const auto& t : mesh.triangles.colwise()) {
      for (int k = 0; k < 3; ++k) {
        const Edge edge = std::minmax(t[k], t[(k + 1) % 3]);
        if (sectors_.contains(edge.first) && sectors_.contains(edge.second)) edges_.insert(edge);
      }
    }
  }

  /// If fans touch in a single vertex, a free sector ends at the next fan, not at its own.
  void part(int vertex, std::vector<Sector>& sectors) const {
    std::vector<Sector> parted;
    std::set<int> ends;
    for (const Sector& sector : sectors) {
      const auto angle = [&](const Sector& other) {
        return turn(at(sector[0]) - at(vertex), at(other[1]) - at(vertex), normal(vertex));
      };
      const auto nearest =
          std::min_element(sectors.begin(), sectors.end(),
                           [&](const Sector& a, const Sector& b) { return angle(a) < angle(b); });
      parted.push_back({sector[0], (*nearest)[1]});
      ends.insert((*nearest)[1]);
    }
    if (ends.size() == sectors.size()) sectors = parted;  // else they overlap, seen from here
  }

  [[nodiscard]] bool joinable(int vertex) const {
    return seam_.may_join[static_cast<std::size_t>(vertex)];
  }

  [[nodiscard]] bool measured(int vertex) const {
    return !seam_.laid_bare[static_cast<std::size_t>(vertex)];
  }

  /// Pairs of nearby border vertices, found in a grid of cubes, that may become edges of the seam,
  /// shortest first.
  std::vector<Candidate> candidates() {
    double cell_size = 0;
    for (const auto& [v, sectors] : sectors_) {
      if (joinable(v)) cell_size = std::max(cell_size, longest(v, v, true));
    }
    if (cell_size == 0) return {};  // nothing to join
    using Cube = std::array<long, 3>;
    std::map<Cube, std::vector<int>> grid;
    const auto cell_of = [&](int v) {
      const Eigen::Array3d cell =
          ((at(v) - vertices_.col(0)) / cell_size).array().floor().max(-kFarCell).min(kFarCell);
      return Cube{static_cast<long>(cell[0]), static_cast<long>(cell[1]),
                  static_cast<long>(cell[2])};
    };
    for (const auto& [v, sectors] : sectors_) grid[cell_of(v)].push_back(v);
    std::vector<Candidate> found;
    for (const auto& [v, sectors] : sectors_) {
      const Cube cell = cell_of(v);
      std::vector<int>& near = near_[v];
      for (int i = 0; i < 27; ++i) {
        const auto place =
            grid.find({cell[0] + i % 3 - 1, cell[1] + i / 3 % 3 - 1, cell[2] + i / 9 - 1});
        if (place == grid.end()) continue;
        for (const int w : place->second) {
          const double squared = (at(v) - at(w)).squaredNorm();
          if (squared > cell_size * cell_size) continue;
          near.push_back(w);
          if (v < w && may_be_edge(v, w, squared)) found.push_back({squared, {v, w}});
        }
      }
    }
    std::sort(found.begin(), found.end(),
              [](const Candidate& a, const Candidate& b) { return a.key() < b.key(); });
    return found;
  }

  [[nodiscard]] bool may_be_edge(int v, int w, double squared_length) const {
    if (!joinable(v) || !joinable(w) || edges_.contains({v, w})) return false;
    const bool crosses_gap =
        seam_.piece[static_cast<std::size_t>(v)] != seam_.piece[static_cast<std::size_t>(w)];
    // A notch in the border of one scan does not belong to the seam.
    if (!crosses_gap && measured(v) && measured(w)) return false;
    const double limit = longest(v, w, crosses_gap);
    return squared_length > 0 && squared_length <= limit * limit && normal(v).dot(normal(w)) > 0;
  }

  /// [mm] Largest length of an edge between two vertices.
  [[nodiscard]] double longest(int v, int w, bool crosses_gap) const {
    const double spacing = std::max(seam_.spacing[v], seam_.spacing[w]);
    return crosses_gap ? std::hypot(kLongestAcross * spacing, seam_.step) : kLongestAlong * spacing;
  }

  /// Angle from one direction counter-clockwise to another, seen against the normal; [0, 2 pi).
  static double turn(const Vector3d& from, const Vector3d& to, const Vector3d& normal) {
    const Vector3d x = from - from.dot(normal) * normal;
    const double angle = std::atan2(normal.dot(x.cross(to)), x.dot(to));
    return angle < 0 ? angle + 2 * std::numbers::pi : angle;
  }

  /// Position of an edge from `vertex` to `to`: its sector, and the position in it.
  [[nodiscard]] std::optional<std::pair<std::size_t, std::size_t>> place_at(int vertex,
                                                                            int to) const {
    const std::vector<Sector>& sectors = sectors_.at(vertex);
    for (std::size_t s = 0; s < sectors.size(); ++s) {
      const Sector& sector = sectors[s];
      const Vector3d from = at(sector[0]) - at(vertex);
      const auto angle = [&](int w) { return turn(from, at(w) - at(vertex), normal(vertex)); };
      const double wanted = angle(to);
      double before = 0;
      for (std::size_t i = 1; i < sector.size(); ++i) {
        const double after = angle(sector[i]);
        if (before < wanted && wanted < after) return std::pair(s, i);
        before = after;
      }
    }
    return std::nullopt;
  }

  /// Returns true if two edges without a common end cross, seen along the normal.
  [[nodiscard]] bool cross(const Edge& a, const Edge& b, const Vector3d& normal) const {
    const auto side = [&](const Edge& line, int vertex) {
      return normal.dot((at(line.second) - at(line.first)).cross(at(vertex) - at(line.first)));
    };
    return side(a, b.first) * side(a, b.second) < 0 && side(b, a.first) * side(b, a.second) < 0;
  }

  [[nodiscard]] bool crosses_another(const Edge& edge) const {
    const Vector3d along = normal(edge.first) + normal(edge.second);
    // If two edges cross and neither is longer than a cell, two of their ends are within a cell.
    for (const int end : {edge.first, edge.second}) {
      for (const int v : near_.at(end)) {
        if (v == edge.first || v == edge.second || !(normal(v).dot(along) > 0)) continue;
        for (const Sector& sector : sectors_.at(v)) {
          for (const int w : sector) {
            if (w == edge.first || w == edge.second) continue;
            if (cross(edge, {v, w}, along)) return true;
          }
        }
      }
    }
    return false;
  }

  void add_if_free(const Edge& edge) {
    const auto there = place_at(edge.first, edge.second);
    const auto back = place_at(edge.second, edge.first);
    if (!there || !back || crosses_another(edge)) return;
    insert(edge.first, *there, edge.second);
    insert(edge.second, *back, edge.first);
    edges_.insert(edge);
    added_.push_back(edge);
  }

  void insert(int vertex, const std::pair<std::size_t, std::size_t>& place, int to) {
    Sector& sector = sectors_.at(vertex)[place.first];
    sector.insert(sector.begin() + static_cast<std::ptrdiff_t>(place.second), to);
  }

  /// The face on the left of an edge, found by taking the next edge clockwise at each vertex.
  [[nodiscard]] std::vector<int> face(int from, int to) const {
    std::vector<int> corners = {from};
    const int start = from;
    const int second = to;
    while (corners.size() <= kLargestFace) {
      int next = -1;
      for (const Sector& sector : sectors_.at(to)) {
        const auto place = std::find(sector.begin() + 1, sector.end(), from);
        if (place != sector.end()) next = *(place - 1);
      }
      if (to == start && next == second) return corners;
      corners.push_back(to);
      from = std::exchange(to, next);
    }
    return {};
  }

  void collect_triangles() {
    std::set<std::vector<int>> faces;
    const auto add_face = [&](int from, int to) {
      std::vector<int> corners = face(from, to);
      if (!is_of_seam(corners)) return;
      std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
      faces.insert(corners);
    };
    for (const Edge& edge : added_) {
      add_face(edge.first, edge.second);
      add_face(edge.second, edge.first);
    }
    for (const auto& [v, sectors] : sectors_) {
      for (const Sector& sector : sectors) add_face(sector.back(), v);
    }
    for (const std::vector<int>& corners : faces) cut_into_triangles(corners);
  }

  /// Returns true if a face is part of the gap and oriented like the surface: not the outside of an
  /// island, nor a hole of one piece.
  [[nodiscard]] bool is_of_seam(const std::vector<int>& corners) const {
    const std::set<int> distinct(corners.begin(), corners.end());
    if (corners.size() < 3 || distinct.size() != corners.size()) return false;
    const auto count = [&](const auto& property) {
      return static_cast<std::size_t>(std::count_if(corners.begin(), corners.end(), property));
    };
    if (count([&](int v) { return joinable(v); }) < corners.size()) return false;
    const std::size_t laid_bare = corners.size() - count([&](int v) { return measured(v); });
    if (corners.size() > kSmallFace && laid_bare * 3 < corners.size()) return false;
    Vector3d twice_area = Vector3d::Zero();
    Vector3d normals = Vector3d::Zero();
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vector3d first = at(corners[i]) - at(corners[0]);
      twice_area += first.cross(at(corners[(i + 1) % corners.size()]) - at(corners[0]));
      normals += normal(corners[i]);
    }
    return twice_area.dot(normals) > 0;
  }

  /// Clips the ear with the shortest new edge first, and folded ears last; a face stays open if
  /// each new edge would duplicate an existing one.
  void cut_into_triangles(std::vector<int> corners) {
    while (corners.size() > 3) {
      const std::size_t count = corners.size();
      std::size_t best = count;
      std::pair<bool, double> best_key;
      for (std::size_t i = 0; i < count; ++i) {
        const int before = corners[(i + count - 1) % count];
        const int after = corners[(i + 1) % count];
        if (edges_.contains(std::minmax(before, after))) continue;
        const Vector3d twice_area = (at(corners[i]) - at(before)).cross(at(after) - at(before));
        const bool folded =
            !(twice_area.dot(normal(before) + normal(corners[i]) + normal(after)) > 0);
        const std::pair key(folded, (at(before) - at(after)).squaredNorm());
        if (best == count || key < best_key) {
          best = i;
          best_key = key;
        }
      }
      if (best == count) return;
      const int before = corners[(best + count - 1) % count];
      const int after = corners[(best + 1) % count];
      triangles_.emplace_back(before, corners[best], after);
      edges_.insert(std::minmax(before, after));
      corners.erase(corners.begin() + static_cast<std::ptrdiff_t>(best));
    }
    triangles_.emplace_back(corners[0], corners[1], corners[2]);
  }

  const Eigen::Matrix3Xd& vertices_;
  const Seam& seam_;
  std::map<int, std::vector<Sector>> sectors_;
  std::map<int, std::vector<int>> near_;
  std::set<Edge> edges_;
  std::vector<Edge> added_;
  std::vector<Eigen::Vector3i> triangles_;
};

}  // namespace

Eigen::Matrix3Xi close_seam(const TriangleMesh& mesh, const Seam& seam) {
  return SeamTriangulation(mesh, seam).run();
}

}  // namespace palpate::geometry
