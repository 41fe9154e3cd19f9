// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "scans/registered_scans.h"

#include <cstddef>

#include "base/numbers.h"
#include "base/rigid_motion.h"
#include "palpate/core/error.h"
#include "palpate/core/quantile.h"
#include "palpate/geometry/mesh_topology.h"

namespace palpate::geometry {

std::string scan_name(std::span<const Scan> scans, std::size_t i, const std::string& caller) {
  return scans[i].name.empty() ? caller + ": scan " + std::to_string(i) : scans[i].name;
}

std::vector<TriangleMesh> in_frame_of_object(std::span<const Scan> scans,
                                             const std::string& caller) {
  if (scans.empty()) throw InvalidInput(caller + ": there is no scan");
  std::vector<TriangleMesh> meshes;
  for (std::size_t i = 0; i < scans.size(); ++i) {
    const std::string name = scan_name(scans, i, caller);
    check_mesh(scans[i].mesh, name.c_str());
    if (!is_rigid(scans[i].T_object_scan)) {
      throw InvalidInput(name + ": T_object_scan is not a rotation and a finite shift");
    }
    if (scans[i].viewpoint && !scans[i].viewpoint->allFinite())
      throw InvalidInput(name + ": its viewpoint is not finite");
    meshes.push_back({.vertices = scans[i].T_object_scan * scans[i].mesh.vertices,
                      .triangles = scans[i].mesh.triangles});
  }
  return meshes;
}

void require_manifold(std::span<const Scan> scans, const std::string& caller) {
  for (std::size_t i = 0; i < scans.size(); ++i) {
    try {
      (void)opposite_half_edges(scans[i].mesh);
    } catch (const InvalidInput& error) {
      throw InvalidInput(scan_name(scans, i, caller) + " is not manifold; " + error.what() +
                         ". repair_mesh (palpate mesh --repair) mends it");
    }
  }
}

double median_edge_length(const std::vector<TriangleMesh>& meshes, const std::string& caller) {
  std::vector<double> lengths;
  for (const TriangleMesh& mesh : meshes) {
    for (const auto& t : mesh.triangles.colwise()) {
      for (int k = 0; k < 3; ++k) {
        lengths.push_back((mesh.vertices.col(t[k]) - mesh.vertices.col(t[(k + 1) % 3])).norm());
      }
    }
  }
  const double median = quantile(lengths, 0.5);
  if (!(median > 0)) {
    throw InvalidInput(caller + ": the median edge of the scans has no length");
  }
  return median;
}

}  // namespace palpate::geometry
