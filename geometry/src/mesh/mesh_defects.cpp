// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/mesh_defects.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <set>
#include <span>

#include "mesh/edge_table.h"

namespace palpate::geometry {
namespace {

constexpr size_t kNamed = 5;  ///< elements that a description lists

class Search {
 public:
  explicit Search(const TriangleMesh& mesh)
      : mesh_(mesh), sound_(static_cast<size_t>(mesh.triangles.cols())) {
    check_vertices();
    for (int t = 0; t < mesh.triangles.cols(); ++t) check_corners(t);
    check_repeats();
    check_edges();
    check_shapes();
  }

  [[nodiscard]] std::vector<MeshDefect> found() const {
    std::vector<MeshDefect> defects;
    for (const auto& [kind, elements] : found_)
      defects.push_back({kind, {elements.begin(), elements.end()}});
    return defects;
  }

 private:
  void add(DefectKind kind, int element) { found_[kind].insert(element); }

  void check_vertices() {
    std::vector<bool> used(static_cast<size_t>(mesh_.vertices.cols()));
    for (const int corner : mesh_.triangles.reshaped()) {
      if (corner >= 0 && corner < mesh_.vertices.cols()) used[static_cast<size_t>(corner)] = true;
    }
    for (int v = 0; v < mesh_.vertices.cols(); ++v) {
      if (!mesh_.vertices.col(v).allFinite()) add(DefectKind::infinite_vertex, v);
      if (!used[static_cast<size_t>(v)]) add(DefectKind::vertex_isolated, v);
    }
  }

  void check_corners(int t) {
    const Eigen::Vector3i corners = mesh_.triangles.col(t);
    const bool in_range = corners.minCoeff() >= 0 && corners.maxCoeff() < mesh_.vertices.cols();
    const bool differ =
        corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0];
    if (!in_range) add(DefectKind::corner_out_of_range, t);
    if (!differ) add(DefectKind::corner_repeated, t);
    sound_[static_cast<size_t>(t)] = in_range && differ;
  }

  void check_repeats() {
    for (const int t : repeated_triangles(mesh_.triangles, sound_)) {
      add(DefectKind::triangle_repeated, t);
      sound_[static_cast<size_t>(t)] = false;
    }
  }

  void check_edges() {
    CornerClasses fans(mesh_.triangles.size());
    for_each_edge(sort_sides(mesh_.triangles, sound_), [&](std::span<const EdgeSide> sides) {
      for (size_t i = 1; i < sides.size(); ++i) {
        fans.join(sides[0], sides[i]);
        if (i > 1) {
          add(DefectKind::edge_overfull, sides[i].triangle());
        } else if (sides[1].upwards == sides[0].upwards) {
          add(DefectKind::triangle_turned, sides[1].triangle());
        }
      }
    });
    std::map<int, int> fan_of_vertex;
    for (int corner = 0; corner < mesh_.triangles.size(); ++corner) {
      if (!sound_[static_cast<size_t>(corner / 3)]) continue;
      const int vertex = mesh_.triangles(corner % 3, corner / 3);
      const int fan = fans.find(corner);
      if (fan_of_vertex.try_emplace(vertex, fan).first->second != fan)
        add(DefectKind::vertex_pinched, vertex);
    }
  }

  void check_shapes() {
    TriangleMesh sound;
    sound.vertices = mesh_.vertices;
    std::vector<int> original;
    for (int t = 0; t < mesh_.triangles.cols(); ++t) {
      if (sound_[static_cast<size_t>(t)] && corners_finite(t)) original.push_back(t);
    }
    sound.triangles = mesh_.triangles(Eigen::all, original);
    const Eigen::Matrix3Xd normals = triangle_normals(sound);
    for (Eigen::Index i = 0; i < normals.cols(); ++i) {
      const int t = original[static_cast<size_t>(i)];
      if (!normals.col(i).allFinite()) {
        add(DefectKind::triangle_flat, t);
      } else if (is_needle(t)) {
        add(DefectKind::triangle_needle, t);
      }
    }
  }

  [[nodiscard]] bool corners_finite(int t) const {
    return mesh_.vertices(Eigen::all, mesh_.triangles.col(t)).allFinite();
  }

  [[nodiscard]] bool is_needle(int t) const {
    const Eigen::Matrix3d corners = mesh_.vertices(Eigen::all, mesh_.triangles.col(t));
    const Eigen::Vector3d ab = corners.col(1) - corners.col(0);
    const Eigen::Vector3d ac = corners.col(2) - corners.col(0);
    const double longest = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    return ab.cross(ac).norm() < kNeedleHeight * longest;
  }

  const TriangleMesh& mesh_;
  std::vector<bool> sound_;  ///< corners in range and different, the first of its repeats
  std::map<DefectKind, std::set<int>> found_;
};

const char* words(DefectKind kind) {
  switch (kind) {
    case DefectKind::infinite_vertex:
      return "vertices that are not finite";
    case DefectKind::corner_out_of_range:
      return "triangles that refer to a vertex that does not exist";
    case DefectKind::corner_repeated:
      return "triangles that use a vertex twice";
    case DefectKind::triangle_repeated:
      return "triangles that repeat an earlier one";
    case DefectKind::triangle_turned:
      return "triangles with the opposite orientation of a neighbour";
    case DefectKind::edge_overfull:
      return "triangles at an edge that two earlier triangles share";
    case DefectKind::vertex_pinched:
      return "vertices that join several fans of triangles";
    case DefectKind::vertex_isolated:
      return "vertices in no triangle";
    case DefectKind::triangle_flat:
      return "triangles without area";
    case DefectKind::triangle_needle:
      return "needle triangles";
    case DefectKind::triangle_intersecting:
      return "triangles that intersect others";
  }
  return "";
}

}  // namespace

std::vector<MeshDefect> find_defects(const TriangleMesh& mesh) { return Search(mesh).found(); }

const char* to_string(DefectKind kind) {
  switch (kind) {
    case DefectKind::infinite_vertex:
      return "infinite_vertex";
    case DefectKind::corner_out_of_range:
      return "corner_out_of_range";
    case DefectKind::corner_repeated:
      return "corner_repeated";
    case DefectKind::triangle_repeated:
      return "triangle_repeated";
    case DefectKind::triangle_turned:
      return "triangle_turned";
    case DefectKind::edge_overfull:
      return "edge_overfull";
    case DefectKind::vertex_pinched:
      return "vertex_pinched";
    case DefectKind::vertex_isolated:
      return "vertex_isolated";
    case DefectKind::triangle_flat:
      return "triangle_flat";
    case DefectKind::triangle_needle:
      return "triangle_needle";
    case DefectKind::triangle_intersecting:
      return "triangle_intersecting";
  }
  return "";
}

std::string describe(const MeshDefect& defect) {
  std::string text = words(defect.kind);
  text += ": " + std::to_string(defect.elements.size()) + " (";
  const size_t named = std::min(kNamed, defect.elements.size());
  for (size_t i = 0; i < named; ++i) {
    if (i > 0) text += ", ";
    text += std::to_string(defect.elements[i]);
  }
  return text + (named < defect.elements.size() ? ", ...)" : ")");
}

}  // namespace palpate::geometry
