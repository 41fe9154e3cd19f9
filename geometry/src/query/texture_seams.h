// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "palpate/geometry/surface_query.h"
#include "palpate/geometry/texture.h"
#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A mesh whose vertices have one place in the texture each: vertices at seams occur once for each
/// chart.
struct SeamedMesh {
  TriangleMesh mesh;         ///< the same triangles, in their order
  std::vector<int> source;   ///< of each vertex: the vertex of the mesh that was split; ascending
  Eigen::Matrix2Xd texture;  ///< of each vertex; NaN where there is none
  std::vector<int> number;   ///< of each vertex: as `CornerTexture::number`; -1 if there are none
};

/// \throws InvalidInput unless the texture has as many triangles as the mesh.
[[nodiscard]] SeamedMesh split_at_seams(const TriangleMesh& mesh, const CornerTexture& texture);

/// The texture of the input of a decimation, to be compared with.
class TextureStandard {
 public:
  explicit TextureStandard(const SeamedMesh& input);

  /// Returns true if the texture is displaced by more than the tolerance at one of seven places of
  /// a triangle (its centre, half-way from there to its corners, the middle of its sides): if the
  /// nearest place of the same chart of the input is farther away, or the texture there differs
  /// from that of the place by more than that, in mm along the input.
  /// \param mesh with the vertices of the input.
  [[nodiscard]] bool slips(const TriangleMesh& mesh, int triangle, double tolerance) const;

 private:
  Eigen::Matrix2Xd texture_;  ///< of each vertex
  std::vector<int> chart_;    ///< of each vertex
  double apart_;              ///< [mm] between charts
  int side_;                  ///< of the cube of charts
  TriangleMesh charts_;       ///< the input, its charts moved apart
  Eigen::VectorXd stretch_;   ///< [mm per unit of the texture] most, of each triangle
  std::optional<SurfaceQuery> query_;

  [[nodiscard]] Eigen::Vector3d shift(int chart) const;
};

}  // namespace palpate::geometry
