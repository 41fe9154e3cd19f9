// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/merge_scans.h"

#include <cstddef>
#include <vector>

#include "palpate/error.h"
#include "palpate/geometry/mesh_repair.h"
#include "palpate/geometry/surface_query.h"
#include "palpate/require.h"
#include "scans/poisson_surface.h"
#include "scans/registered_scans.h"

namespace palpate::geometry {
namespace {

/// Points of all scans, each with its normal.
struct OrientedPoints {
  Eigen::Matrix3Xd points;
  Eigen::Matrix3Xd normals;
};

OrientedPoints points_with_normals(const std::vector<TriangleMesh>& meshes) {
  Eigen::Index count = 0;
  for (const TriangleMesh& mesh : meshes) count += mesh.vertices.cols();
  OrientedPoints all{.points = Eigen::Matrix3Xd(3, count), .normals = Eigen::Matrix3Xd(3, count)};
  Eigen::Index next = 0;
  for (const TriangleMesh& mesh : meshes) {
    const Eigen::Matrix3Xd normals = vertex_normals(mesh);
    for (Eigen::Index v = 0; v < normals.cols(); ++v) {
      if (!normals.col(v).allFinite()) continue;
      all.points.col(next) = mesh.vertices.col(v);
      all.normals.col(next++) = normals.col(v);
    }
  }
  all.points.conservativeResize(3, next);
  all.normals.conservativeResize(3, next);
  return all;
}

/// The triangles whose corners are all kept.
Eigen::Matrix3Xi triangles_between(const TriangleMesh& mesh, const std::vector<bool>& keep) {
  Eigen::Matrix3Xi triangles(3, mesh.triangles.cols());
  Eigen::Index count = 0;
  for (const auto& t : mesh.triangles.colwise()) {
    const auto kept = [&](int v) { return keep[static_cast<std::size_t>(v)]; };
    if (kept(t[0]) && kept(t[1]) && kept(t[2])) triangles.col(count++) = t;
  }
  triangles.conservativeResize(3, count);
  return triangles;
}

/// Which vertices are within `distance` of a scan.
std::vector<bool> near_scans(const TriangleMesh& mesh, const std::vector<TriangleMesh>& scans,
                             double distance) {
  std::vector<bool> near(static_cast<std::size_t>(mesh.vertices.cols()), false);
  for (const TriangleMesh& scan : scans) {
    const ClosestPoints closest = closest_points(SurfaceQuery(scan), mesh.vertices);
    for (std::size_t v = 0; v < near.size(); ++v) {
      if (closest.distances[static_cast<Eigen::Index>(v)] <= distance) near[v] = true;
    }
  }
  return near;
}

}  // namespace

MergedScans merge_scans(std::span<const Scan> scans, const MergeScansOptions& options) {
  require("MergeScansOptions::reach", options.reach, above(0));
  const std::vector<TriangleMesh> meshes = in_frame_of_object(scans, "merge_scans");
  MergedScans merged{.mesh = {}, .spacing = median_edge_length(meshes, "merge_scans")};
  const OrientedPoints all = points_with_normals(meshes);
  if (all.points.cols() == 0) {
    throw InvalidInput("merge_scans: no vertex of the scans has a normal");
  }
  merged.points = static_cast<int>(all.points.cols());
  const TriangleMesh closed = poisson_surface(all.points, all.normals, merged.spacing);
  const TriangleMesh trimmed{
      .vertices = closed.vertices,
      .triangles =
          triangles_between(closed, near_scans(closed, meshes, options.reach * merged.spacing))};
  if (trimmed.triangles.cols() == 0) {
    throw SolverError("merge_scans: no triangle of the surface is within reach of a scan");
  }
  merged.trimmed = static_cast<int>(closed.triangles.cols() - trimmed.triangles.cols());
  // Vertices without triangles are left over, and some vertices with two fans.
  merged.mesh = repair_mesh(trimmed).mesh;
  return merged;
}

}  // namespace palpate::geometry
