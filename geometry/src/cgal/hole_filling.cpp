// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/hole_filling.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>

#include <Eigen/Geometry>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/cgal_mesh.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
// CGAL searches patches in a Delaunay tetrahedralisation, which needs exact predicates.
using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
using Surface = CGAL::Surface_mesh<Point>;

/// A border loop is the outline of its component, and no hole in it, iff the bounding box of the
/// component is at most this many times as large. That of a hemisphere is 1.06 times as large.
constexpr double kOutline = 1.05;

/// Patches depend on the triangles that touch the border; these and their neighbours are copied.
constexpr int kCopiedRings = 2;

std::size_t at(Eigen::Index i) { return static_cast<std::size_t>(i); }

/// Counts the half-edges that leave the start of `first`, from it on until the border or itself.
int count_fan(const Eigen::Matrix3Xi& opposite, int first, std::vector<bool>& counted) {
  int count = 0;
  for (int h = first; h >= 0 && !counted[at(h)];) {
    counted[at(h)] = true;
    ++count;
    h = opposite.data()[h % 3 == 0 ? h + 2 : h - 1];
  }
  return count;
}

/// \throws InvalidInput naming a vertex round which triangles close while it has others too.
void check_fans(const TriangleMesh& mesh, const Eigen::Matrix3Xi& opposite) {
  const int half_edges = static_cast<int>(opposite.size());
  std::vector<int> left(at(mesh.vertices.cols()), 0);  // half-edges not counted yet
  for (int h = 0; h < half_edges; ++h) ++left[at(mesh.triangles.data()[h])];
  std::vector<bool> counted(at(half_edges), false);
  std::vector<bool> is_open(left.size(), false);
  for (int h = 0; h < half_edges; ++h) {
    if (opposite.data()[h] >= 0) continue;
    const std::size_t vertex = at(mesh.triangles.data()[h]);
    left[vertex] -= count_fan(opposite, h, counted);
    is_open[vertex] = true;
  }
  for (int h = 0; h < half_edges; ++h) {
    if (counted[at(h)]) continue;
    const std::size_t vertex = at(mesh.triangles.data()[h]);
    left[vertex] -= count_fan(opposite, h, counted);
    if (left[vertex] > 0 || is_open[vertex]) {
      throw InvalidInput("mesh: vertex " + std::to_string(vertex) +
                         " makes it non-manifold: triangles close round it, and others touch it");
    }
  }
}

/// The part of a mesh that patches depend on.
struct BorderRegion {
  TriangleMesh mesh;
  std::vector<int> vertices;   ///< of the whole mesh, ascending
  std::vector<int> triangles;  ///< of the whole mesh, ascending
};

BorderRegion border_region(const TriangleMesh& mesh, const Eigen::Matrix3Xi& opposite) {
  std::vector<bool> is_near(at(mesh.vertices.cols()), false);
  for (Eigen::Index t = 0; t < mesh.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      if (opposite(k, t) >= 0) continue;
      is_near[at(mesh.triangles(k, t))] = true;
      is_near[at(mesh.triangles((k + 1) % 3, t))] = true;
    }
  }
  BorderRegion region;
  for (int ring = 0; ring < kCopiedRings; ++ring) {
    region.triangles.clear();
    for (int t = 0; t < mesh.triangles.cols(); ++t) {
      const Eigen::Vector3i corners = mesh.triangles.col(t);
      if (is_near[at(corners[0])] || is_near[at(corners[1])] || is_near[at(corners[2])])
        region.triangles.push_back(t);
    }
    for (const int t : region.triangles) {
      for (const int vertex : mesh.triangles.col(t)) is_near[at(vertex)] = true;
    }
  }
  std::vector<int> index(is_near.size(), -1);
  for (std::size_t v = 0; v < is_near.size(); ++v) {
    if (!is_near[v]) continue;
    index[v] = static_cast<int>(region.vertices.size());
    region.vertices.push_back(static_cast<int>(v));
  }
  region.mesh.vertices = mesh.vertices(Eigen::all, region.vertices);
  region.mesh.triangles = mesh.triangles(Eigen::all, region.triangles);
  for (int& vertex : region.mesh.triangles.reshaped()) vertex = index[at(vertex)];
  return region;
}

/// [mm] diagonal of the bounding box of a border loop.
double diameter(const Surface& surface, Surface::Halfedge_index border) {
  CGAL::Bbox_3 box;
  for (const auto h : CGAL::halfedges_around_face(border, surface))
    box += surface.point(surface.target(h)).bbox();
  return Eigen::Vector3d(box.x_span(), box.y_span(), box.z_span()).norm();
}

/// Tells how large the components of a mesh are, at a cost that grows with the answer.
class ComponentSizes {
 public:
  ComponentSizes(const TriangleMesh& mesh, const Eigen::Matrix3Xi& opposite)
      : mesh_(mesh), opposite_(opposite), visit_(at(mesh.triangles.cols()), 0) {}

  /// Returns true if the bounding box of a triangle's component has a diagonal > `limit` [mm].
  [[nodiscard]] bool exceeds(int triangle, double limit) {
    ++last_visit_;
    Eigen::AlignedBox3d box;
    std::vector<int> reached = {triangle};
    visit_[at(triangle)] = last_visit_;
    for (std::size_t i = 0; i < reached.size(); ++i) {
      for (int k = 0; k < 3; ++k) {
        box.extend(mesh_.vertices.col(mesh_.triangles(k, reached[i])));
        const int across = opposite_(k, reached[i]);
        if (across < 0 || visit_[at(across / 3)] == last_visit_) continue;
        visit_[at(across / 3)] = last_visit_;
        reached.push_back(across / 3);
      }
      if (box.diagonal().norm() > limit) return true;
    }
    return false;
  }

 private:
  const TriangleMesh& mesh_;
  const Eigen::Matrix3Xi& opposite_;
  std::vector<int> visit_;  ///< the last visit that reached each triangle
  int last_visit_ = 0;
};

/// The triangle of the whole mesh at a border half-edge; none where the region was cut off.
std::optional<int> triangle_at(const Surface& surface, Surface::Halfedge_index border,
                               const BorderRegion& region, const Eigen::Matrix3Xi& opposite) {
  const Eigen::Index face = static_cast<unsigned>(surface.face(surface.opposite(border)));
  const int from = static_cast<int>(static_cast<unsigned>(surface.target(border)));
  const int triangle = region.triangles[at(face)];
  for (int k = 0; k < 3; ++k) {
    if (region.mesh.triangles(k, face) == from && opposite(k, triangle) < 0) return triangle;
  }
  return std::nullopt;
}

/// The whole mesh with the vertices and triangles that were added to the region.
TriangleMesh with_patches(const TriangleMesh& mesh, const BorderRegion& region,
                          const TriangleMesh& filled) {
  const Eigen::Index old_vertices = region.mesh.vertices.cols();
  const Eigen::Index new_vertices = filled.vertices.cols() - old_vertices;
  const Eigen::Index new_triangles = filled.triangles.cols() - region.mesh.triangles.cols();
  TriangleMesh result;
  result.vertices.resize(3, mesh.vertices.cols() + new_vertices);
  result.vertices << mesh.vertices, filled.vertices.rightCols(new_vertices);
  result.triangles.resize(3, mesh.triangles.cols() + new_triangles);
  result.triangles << mesh.triangles, filled.triangles.rightCols(new_triangles);
  const auto shift = static_cast<int>(mesh.vertices.cols() - old_vertices);
  for (int& vertex : result.triangles.rightCols(new_triangles).reshaped())
    vertex = vertex < old_vertices ? region.vertices[at(vertex)] : vertex + shift;
  return result;
}

bool fill(Surface& surface, Surface::Halfedge_index border) {
  std::vector<Surface::Face_index> faces;
  std::vector<Surface::Vertex_index> vertices;
  try {
    pmp::triangulate_refine_and_fair_hole(surface, border, std::back_inserter(faces),
                                          std::back_inserter(vertices));
  } catch (const CGAL::Failure_exception& failure) {
    const Point& rim = surface.point(surface.target(border));
    throw SolverError("the hole at (" + std::to_string(rim.x()) + ", " + std::to_string(rim.y()) +
                      ", " + std::to_string(rim.z()) +
                      ") mm could not be filled: " + failure.what());
  }
  return !faces.empty();
}

}  // namespace

FilledMesh fill_holes(const TriangleMesh& mesh, const HoleFillingOptions& options) {
  check_hole_filling(options);
  const double max_diameter = *options.max_diameter;
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  check_fans(mesh, opposite);
  FilledMesh result;
  const BorderRegion region = border_region(mesh, opposite);
  if (region.triangles.empty()) {
    result.mesh = mesh;
    return result;
  }
  Surface surface = to_surface_mesh<Point>(region.mesh);
  std::vector<Surface::Halfedge_index> loops;
  pmp::extract_boundary_cycles(surface, std::back_inserter(loops));
  ComponentSizes components(mesh, opposite);
  const auto is_hole = [&](Surface::Halfedge_index border, int triangle) {
    const double width = diameter(surface, border);
    return width <= max_diameter &&
           (std::isinf(max_diameter) || components.exceeds(triangle, kOutline * width));
  };
  std::erase_if(loops,
                [&](const auto border) { return !triangle_at(surface, border, region, opposite); });
  const int total = static_cast<int>(loops.size());
  for (int i = 0; i < total; ++i) {
    const auto border = loops[at(i)];
    if (is_hole(border, *triangle_at(surface, border, region, opposite)) && fill(surface, border)) {
      ++result.filled;
    } else {
      ++result.left;
    }
    if (options.progress) options.progress(i + 1, total);
  }
  result.mesh = with_patches(mesh, region, from_surface_mesh(surface));
  return result;
}

}  // namespace palpate::geometry
