// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Geometry>
#include <span>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct DeformationGraphOptions {
  /// Number of nodes on the surface, >= 1; at least one per connected piece, and at most one per
  /// vertex. The smallest dent that can be represented is about two node spacings wide.
  int nodes = 800;
};

/// Deformation graph: a surface deformed by few parameters (Sumner, Schmid and Pauly 2007). Each of
/// several hundred nodes has a rigid motion M_k, blended in between:
///
///     v' = sum_k w_k M_k v        k: the kInfluences nodes nearest to v along the surface
///
/// Distances follow the edges of the mesh, so neighbouring fingers of a glove do not affect each
/// other. Nodes are placed by farthest point sampling: evenly, and on the border too. A weight
/// falls to zero where a closer node replaces it, so the blend is continuous except at the few
/// places that are equally far from kInfluences + 1 nodes. A vertex without triangles follows the
/// nearest node in space. Differs from the paper: motions are rigid, not affine; stretching comes
/// from the differences between nodes. Constant after construction, thread-safe.
class DeformationGraph {
 public:
  static constexpr int kInfluences = 3;  ///< number of nodes that move a vertex
  using Influences = Eigen::Matrix<int, kInfluences, Eigen::Dynamic>;
  using Weights = Eigen::Matrix<double, kInfluences, Eigen::Dynamic>;

  /// \throws InvalidInput if the mesh or an option is not valid.
  explicit DeformationGraph(TriangleMesh mesh, const DeformationGraphOptions& options = {});

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }            ///< undeformed
  [[nodiscard]] const Eigen::Matrix3Xd& normals() const { return normals_; }  ///< of its vertices
  /// The undeformed vertices without the noise of single ones, 3 x V [mm].
  [[nodiscard]] const Eigen::Matrix3Xd& smooth_vertices() const { return smooth_vertices_; }
  /// [mm] 3 x N, some of the smooth vertices
  [[nodiscard]] const Eigen::Matrix3Xd& nodes() const { return nodes_; }
  [[nodiscard]] double spacing() const { return spacing_; }  ///< [mm] mean length of the edges
  /// Pairs a < b of nodes that influence a common vertex, 2 x E, ascending.
  [[nodiscard]] const Eigen::Matrix2Xi& edges() const { return edges_; }
  /// Nodes of each vertex, kInfluences x V, ascending; repeated with weight 0 if there are fewer.
  [[nodiscard]] const Influences& influences() const { return influences_; }
  [[nodiscard]] const Weights& weights() const {
    return weights_;
  }  ///< >= 0, each column sums to 1

 private:
  TriangleMesh mesh_;
  Eigen::Matrix3Xd normals_;
  Eigen::Matrix3Xd smooth_vertices_;
  Eigen::Matrix3Xd nodes_;
  double spacing_ = 0;
  Eigen::Matrix2Xi edges_;
  Influences influences_;
  Weights weights_;
};

/// The vertices of the graph's mesh, 3 x V [mm], for given motions of its nodes.
/// \throws InvalidInput unless there is one motion per node.
[[nodiscard]] Eigen::Matrix3Xd deformed_vertices(const DeformationGraph& graph,
                                                 std::span<const Eigen::Isometry3d> node_motions);

}  // namespace palpate::geometry
