// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/geometry/register_scans.h"

#include <cstddef>

#include "scans/registered_scans.h"

namespace palpate::geometry {
namespace {

constexpr std::size_t kMaxPoints = 20000;

/// Adds a mesh beside another; triangles are not joined.
void append(TriangleMesh& mesh, const TriangleMesh& other) {
  const Eigen::Index vertices = mesh.vertices.cols(), triangles = mesh.triangles.cols();
  mesh.vertices.conservativeResize(3, vertices + other.vertices.cols());
  mesh.vertices.rightCols(other.vertices.cols()) = other.vertices;
  mesh.triangles.conservativeResize(3, triangles + other.triangles.cols());
  mesh.triangles.rightCols(other.triangles.cols()) =
      other.triangles.array() + static_cast<int>(vertices);
}

}  // namespace

Eigen::Matrix3Xd registration_points(const TriangleMesh& mesh) {
  std::vector<bool> is_used(static_cast<std::size_t>(mesh.vertices.cols()));
  for (const int v : mesh.triangles.reshaped()) is_used[static_cast<std::size_t>(v)] = true;
  std::vector<int> used;
  for (std::size_t v = 0; v < is_used.size(); ++v)
    if (is_used[v]) used.push_back(static_cast<int>(v));
  const std::size_t step = (used.size() + kMaxPoints - 1) / kMaxPoints;
  std::vector<int> chosen;
  for (std::size_t i = 0; i < used.size(); i += step) chosen.push_back(used[i]);
  return mesh.vertices(Eigen::all, chosen);
}

std::vector<Registration> register_scans(std::span<const Scan> scans,
                                         const RegistrationOptions& options) {
  TriangleMesh before = in_frame_of_object(scans, "register_scans").front();
  std::vector<Registration> moves;
  for (std::size_t i = 1; i < scans.size(); ++i) {
    RegistrationOptions from_pose = options;
    from_pose.T_target_source_start = scans[i].T_object_scan;
    from_pose.progress = [&](int done, int total) {
      const auto before_it = static_cast<int>(i) - 1, all = static_cast<int>(scans.size()) - 1;
      if (options.progress) options.progress(before_it * total + done, all * total);
    };
    moves.push_back(register_points(registration_points(scans[i].mesh), before, from_pose));
    if (moves.back().verdict != RegistrationVerdict::accepted) break;
    append(before, {.vertices = moves.back().T_target_source * scans[i].mesh.vertices,
                    .triangles = scans[i].mesh.triangles});
  }
  return moves;
}

}  // namespace palpate::geometry
