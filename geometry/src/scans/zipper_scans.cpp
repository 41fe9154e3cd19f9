// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/zipper_scans.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/require.h"
#include "palpate/geometry/geodesic_distance.h"
#include "palpate/geometry/mesh_repair.h"
#include "palpate/geometry/mesh_topology.h"
#include "palpate/geometry/surface_query.h"
#include "scans/registered_scans.h"
#include "scans/scan_seam.h"

namespace palpate::geometry {
namespace {

/// Lengths in point spacings.
constexpr double kLead = 4;       ///< a later scan must be this much farther from its border
constexpr double kSeamGap = 0.5;  ///< between pieces, so that the seam has no needles
/// Rounds of removing triangles that overlap the other piece; the second one only handles those
/// that the first one has exposed.
constexpr int kClipRounds = 4;

/// A surface under construction: oriented, manifold, with measured vertices. A vertex may be
/// unused, or two fans may touch in it.
struct SurfacePiece {
  TriangleMesh mesh;
  std::vector<ScanVertex> source;
  Eigen::Matrix3Xd normals;  ///< of each vertex in its scan, 3 x V
  Eigen::VectorXd spacing;   ///< [mm] mean length of the edges at each vertex in its scan

  [[nodiscard]] bool empty() const { return mesh.triangles.cols() == 0; }
};

/// The corners of half-edges without an opposite: the border vertices.
std::vector<bool> border_vertices(const TriangleMesh& mesh) {
  std::vector<bool> border(static_cast<std::size_t>(mesh.vertices.cols()), false);
  if (mesh.triangles.cols() == 0) return border;
  const Eigen::Matrix3Xi opposite = opposite_half_edges(mesh);
  for (int h = 0; h < opposite.size(); ++h) {
    if (opposite(h % 3, h / 3) >= 0) continue;
    border[static_cast<std::size_t>(mesh.triangles(h % 3, h / 3))] = true;
    border[static_cast<std::size_t>(mesh.triangles((h + 1) % 3, h / 3))] = true;
  }
  return border;
}

/// [mm] mean length of the edges at each vertex, with inner edges counted twice; 0 without edges.
Eigen::VectorXd mean_edge_lengths(const TriangleMesh& mesh) {
  Eigen::VectorXd sum = Eigen::VectorXd::Zero(mesh.vertices.cols());
  Eigen::VectorXd count = Eigen::VectorXd::Zero(mesh.vertices.cols());
  for (const auto& t : mesh.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const int next = t[(k + 1) % 3];
      const double length = (mesh.vertices.col(t[k]) - mesh.vertices.col(next)).norm();
      for (const int v : {t[k], next}) {
        sum[v] += length;
        ++count[v];
      }
    }
  }
  return sum.array() / count.array().max(1);
}

/// [mm] distance along the surface from each vertex to the border; infinite if there is none.
Eigen::VectorXd distance_to_border(const TriangleMesh& mesh) {
  const std::vector<bool> border = border_vertices(mesh);
  const std::vector<SurfacePoint> points = vertex_points(mesh);
  std::vector<SurfacePoint> sources;
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (border[v]) sources.push_back(points[v]);
  }
  if (sources.empty()) {
    return Eigen::VectorXd::Constant(mesh.vertices.cols(), std::numeric_limits<double>::infinity());
  }
  return geodesic_distance(mesh, sources).distance;
}

/// Relations of the vertices of one surface to another surface.
class Overlap {
 public:
  /// Precondition: `mesh` has a triangle.
  Overlap(const TriangleMesh& mesh, const Eigen::Matrix3Xd& points,
          const Eigen::Matrix3Xd& point_normals, double reach)
      : mesh_(mesh),
        points_(points),
        closest_(closest_points(SurfaceQuery(mesh), points)),
        normals_(triangle_normals(mesh)),
        opposite_(opposite_half_edges(mesh)),
        border_(border_vertices(mesh)),
        seen_(static_cast<std::size_t>(points.cols())) {
    for (Eigen::Index v = 0; v < points.cols(); ++v) {
      // A normal that is NaN agrees with none.
      seen_[static_cast<std::size_t>(v)] =
          closest_.distances[v] <= reach && normal_at(v).dot(point_normals.col(v)) > 0;
    }
  }

  /// Within reach, and facing the same way.
  [[nodiscard]] bool sees(Eigen::Index v) const { return seen_[static_cast<std::size_t>(v)]; }

  /// Returns true if it sees the inside of the surface, or its border from closer than `margin`.
  [[nodiscard]] bool covered(Eigen::Index v, double margin) const {
    return sees(v) && (!at_border(v) || beside(v) < margin);
  }

  [[nodiscard]] int triangle(Eigen::Index v) const { return closest_.triangles[v]; }

  /// Returns true if the closest point is on an edge of the border.
  [[nodiscard]] bool at_border(Eigen::Index v) const {
    const int t = closest_.triangles[v];
    for (int k = 0; k < 3; ++k) {
      // Barycentric coordinates of points on an edge are exactly 0 for the corner opposite.
      if (closest_.barycentric((k + 2) % 3, v) == 0 && opposite_(k, t) < 0) return true;
    }
    return touches_border_in_a_corner(v);
  }

  /// Interpolates a value of the surface's vertices at the closest point.
  [[nodiscard]] double value(const Eigen::VectorXd& of_vertices, Eigen::Index v) const {
    return of_vertices(mesh_.triangles.col(triangle(v))).dot(closest_.barycentric.col(v));
  }

 private:
  [[nodiscard]] Eigen::Vector3d normal_at(Eigen::Index v) const {
    return normals_.col(closest_.triangles[v]);
  }

  /// [mm] distance from the closest point, within the plane there.
  [[nodiscard]] double beside(Eigen::Index v) const {
    const Eigen::Vector3d offset = points_.col(v) - closest_.positions.col(v);
    return (offset - offset.dot(normal_at(v)) * normal_at(v)).norm();
  }

  [[nodiscard]] bool touches_border_in_a_corner(Eigen::Index v) const {
    for (int k = 0; k < 3; ++k) {
      if (closest_.barycentric(k, v) == 1)
        return border_[static_cast<std::size_t>(mesh_.triangles(k, triangle(v)))];
    }
    return false;
  }

  const TriangleMesh& mesh_;
  const Eigen::Matrix3Xd& points_;
  ClosestPoints closest_;
  Eigen::Matrix3Xd normals_;
  Eigen::Matrix3Xi opposite_;
  std::vector<bool> border_;  ///< vertices
  std::vector<bool> seen_;
};

/// Drops the triangles for which `drop(t)` holds; returns how many.
int drop_triangles(TriangleMesh& mesh, const auto& drop) {
  Eigen::Index kept = 0;
  for (int t = 0; t < mesh.triangles.cols(); ++t) {
    if (!drop(t)) mesh.triangles.col(kept++) = mesh.triangles.col(t).eval();
  }
  const auto dropped = static_cast<int>(mesh.triangles.cols() - kept);
  mesh.triangles.conservativeResize(3, kept);
  return dropped;
}

int drop_triangles_at(TriangleMesh& mesh, const std::vector<bool>& vertices) {
  return drop_triangles(mesh, [&, triangles = Eigen::Matrix3Xi(mesh.triangles)](int t) {
    return std::any_of(triangles.col(t).begin(), triangles.col(t).end(),
                       [&](int v) { return vertices[static_cast<std::size_t>(v)]; });
  });
}

/// Removes from the surface the triangles that the scan sees from farther inside its own border.
int give_way(SurfacePiece& surface, const SurfacePiece& scan, double reach, double lead) {
  const Overlap overlap(scan.mesh, surface.mesh.vertices, surface.normals, reach);
  const Eigen::VectorXd inside_surface = distance_to_border(surface.mesh);
  const Eigen::VectorXd inside_scan = distance_to_border(scan.mesh);
  std::vector<bool> worse(static_cast<std::size_t>(surface.mesh.vertices.cols()), false);
  for (Eigen::Index v = 0; v < surface.mesh.vertices.cols(); ++v) {
    worse[static_cast<std::size_t>(v)] =
        overlap.sees(v) && overlap.value(inside_scan, v) > inside_surface[v] + lead;
  }
  return drop_triangles_at(surface.mesh, worse);
}

/// Removes from the scan the triangles that cover the surface, or are too close to it for a seam.
int clip(SurfacePiece& scan, const SurfacePiece& surface, double reach, double gap) {
  int dropped = 0;
  if (surface.empty()) return dropped;
  const Overlap on_surface(surface.mesh, scan.mesh.vertices, scan.normals, reach);
  std::vector<bool> covered(static_cast<std::size_t>(scan.mesh.vertices.cols()), false);
  for (Eigen::Index v = 0; v < scan.mesh.vertices.cols(); ++v) {
    covered[static_cast<std::size_t>(v)] = on_surface.covered(v, gap);
  }
  dropped += drop_triangles_at(scan.mesh, covered);
  // A corner of the surface may still extend into a triangle.
  const std::vector<bool> border = border_vertices(surface.mesh);
  for (int round = 0; round < kClipRounds && !scan.empty(); ++round) {
    const Overlap on_scan(scan.mesh, surface.mesh.vertices, surface.normals, reach);
    std::vector<bool> hit(static_cast<std::size_t>(scan.mesh.triangles.cols()), false);
    for (Eigen::Index v = 0; v < surface.mesh.vertices.cols(); ++v) {
      if (border[static_cast<std::size_t>(v)] && on_scan.covered(v, gap))
        hit[static_cast<std::size_t>(on_scan.triangle(v))] = true;
    }
    const int now =
        drop_triangles(scan.mesh, [&](int t) { return hit[static_cast<std::size_t>(t)]; });
    if (now == 0) break;
    dropped += now;
  }
  return dropped;
}

/// Adds the vertices of a piece to a seam. Border vertices may be joined if they were exposed by a
/// cut or saw the other piece before.
void add_to_seam(const SurfacePiece& piece, const TriangleMesh& before,
                 const TriangleMesh& other_before, double reach, Seam& seam) {
  const std::vector<bool> border = border_vertices(piece.mesh);
  const std::vector<bool> border_before = border_vertices(before);
  const Overlap overlap(other_before, piece.mesh.vertices, piece.normals, reach);
  for (std::size_t v = 0; v < border.size(); ++v) {
    const auto column = static_cast<Eigen::Index>(v);
    const bool laid_bare = border[v] && !border_before[v];
    seam.laid_bare.push_back(laid_bare);
    seam.may_join.push_back((laid_bare && piece.normals.col(column).allFinite()) ||
                            (border[v] && overlap.sees(column)));
  }
}

SurfacePiece together(const SurfacePiece& a, const SurfacePiece& b) {
  const Eigen::Index first = a.mesh.vertices.cols();
  SurfacePiece both = a;
  both.source.insert(both.source.end(), b.source.begin(), b.source.end());
  both.normals.conservativeResize(3, first + b.normals.cols());
  both.normals.rightCols(b.normals.cols()) = b.normals;
  both.spacing.conservativeResize(first + b.spacing.size());
  both.spacing.tail(b.spacing.size()) = b.spacing;
  both.mesh.vertices.conservativeResize(3, first + b.mesh.vertices.cols());
  both.mesh.vertices.rightCols(b.mesh.vertices.cols()) = b.mesh.vertices;
  both.mesh.triangles.conservativeResize(3, a.mesh.triangles.cols() + b.mesh.triangles.cols());
  both.mesh.triangles.rightCols(b.mesh.triangles.cols()) =
      b.mesh.triangles.array() + static_cast<int>(first);
  return both;
}

/// Adds triangles to a mesh.
void append(TriangleMesh& mesh, const Eigen::Matrix3Xi& triangles) {
  mesh.triangles.conservativeResize(3, mesh.triangles.cols() + triangles.cols());
  mesh.triangles.rightCols(triangles.cols()) = triangles;
}

class Zipper {
 public:
  Zipper(double spacing, double reach) : spacing_(spacing), reach_(reach * spacing) {}

  /// Joins a scan to the surface.
  void add(SurfacePiece scan) {
    if (surface_.empty()) {
      surface_ = std::move(scan);
      return;
    }
    const TriangleMesh whole_surface = surface_.mesh;
    const TriangleMesh whole_scan = scan.mesh;
    dropped_ += give_way(surface_, scan, reach_, kLead * spacing_);
    dropped_ += clip(scan, surface_, reach_, kSeamGap * spacing_);
    Seam seam;
    add_to_seam(surface_, whole_surface, whole_scan, reach_, seam);
    seam.piece.resize(seam.may_join.size(), false);
    add_to_seam(scan, whole_scan, whole_surface, reach_, seam);
    seam.piece.resize(seam.may_join.size(), true);
    SurfacePiece both = together(surface_, scan);
    seam.normals = both.normals;
    seam.spacing = both.spacing;
    seam.step = reach_;
    append(both.mesh, close_seam(both.mesh, seam));
    surface_ = std::move(both);
  }

  [[nodiscard]] const SurfacePiece& surface() const { return surface_; }
  [[nodiscard]] int dropped() const { return dropped_; }

 private:
  double spacing_;
  double reach_;
  int dropped_ = 0;
  SurfacePiece surface_;
};

}  // namespace

ZipperedScans zipper_scans(std::span<const Scan> scans, const ZipperScansOptions& options) {
  require("ZipperScansOptions::reach", options.reach, above(0).finite());
  const std::vector<TriangleMesh> meshes = in_frame_of_object(scans, "zipper_scans");
  require_manifold(scans, "zipper_scans");
  ZipperedScans result;
  result.spacing = median_edge_length(meshes, "zipper_scans");
  Zipper zipper(result.spacing, options.reach);
  for (std::size_t i = 0; i < meshes.size(); ++i) {
    SurfacePiece scan{.mesh = meshes[i],
                      .source = {},
                      .normals = vertex_normals(meshes[i]),
                      .spacing = mean_edge_lengths(meshes[i])};
    for (int v = 0; v < meshes[i].vertices.cols(); ++v) {
      scan.source.push_back({.scan = static_cast<int>(i), .vertex = v});
    }
    zipper.add(std::move(scan));
  }
  result.dropped = zipper.dropped();
  // Separate fans that touch in one vertex, and leave out vertices without a triangle.
  RepairedMesh repaired = repair_mesh(zipper.surface().mesh);
  result.mesh = std::move(repaired.mesh);
  for (const int v : repaired.source) {
    result.source.push_back(zipper.surface().source[static_cast<std::size_t>(v)]);
  }
  for (const auto& t : result.mesh.triangles.colwise()) {
    const auto scan = [&](int v) { return result.source[static_cast<std::size_t>(v)].scan; };
    result.seam += scan(t[0]) != scan(t[1]) || scan(t[0]) != scan(t[2]);
  }
  return result;
}

}  // namespace palpate::geometry
