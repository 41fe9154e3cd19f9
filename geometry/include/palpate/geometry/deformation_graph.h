// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <span>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

struct DeformationGraphOptions {
  /// Nodes on the surface, >= 1; at least one goes on each piece of a mesh that is in pieces, and
  /// no two on one vertex. The smallest dent that can be followed is about twice their spacing
  /// wide.
  int nodes = 800;
};

/// A surface that can be deformed by few numbers (Sumner, Schmid and Pauly 2007): a rigid motion at
/// each of some hundred nodes, blended in between,
///
///     v' = sum_k w_k M_k v        k: the kInfluences nodes nearest to v along the surface
///
/// Distances run along the edges of the mesh, so neighbouring fingers of a glove do not move one
/// another. Nodes are chosen farthest first: evenly, and on the border too. A weight falls to zero
/// where a nearer node takes over, so the blend is continuous but for the few places that are
/// equally far from kInfluences + 1 nodes. A vertex in no triangle follows the node that is nearest
/// in space. Differs from the paper: the motions are rigid, not affine; what stretches are the
/// differences between nodes.
///
/// Built once for an undeformed mesh; constant after, safe from several threads.
class DeformationGraph {
 public:
  static constexpr int kInfluences = 3;  ///< nodes that move a vertex
  using Influences = Eigen::Matrix<int, kInfluences, Eigen::Dynamic>;
  using Weights = Eigen::Matrix<double, kInfluences, Eigen::Dynamic>;

  /// \throws InvalidInput on a bad mesh or option.
  explicit DeformationGraph(TriangleMesh mesh, const DeformationGraphOptions& options = {});

  [[nodiscard]] const TriangleMesh& mesh() const { return mesh_; }            ///< undeformed
  [[nodiscard]] const Eigen::Matrix3Xd& normals() const { return normals_; }  ///< of its vertices
  [[nodiscard]] const Eigen::Matrix3Xd& nodes() const {
    return nodes_;
  }                                                          ///< [mm] 3 x N, undeformed
  [[nodiscard]] double spacing() const { return spacing_; }  ///< [mm] mean length of the edges
  /// Pairs a < b of nodes that move a vertex together, 2 x E, ascending.
  [[nodiscard]] const Eigen::Matrix2Xi& edges() const { return edges_; }
  /// Nodes of each vertex, kInfluences x V, ascending; repeated, with weight 0, where there are
  /// fewer.
  [[nodiscard]] const Influences& influences() const { return influences_; }
  [[nodiscard]] const Weights& weights() const {
    return weights_;
  }  ///< >= 0, each column sums to 1

 private:
  TriangleMesh mesh_;
  Eigen::Matrix3Xd normals_;
  Eigen::Matrix3Xd nodes_;
  double spacing_ = 0;
  Eigen::Matrix2Xi edges_;
  Influences influences_;
  Weights weights_;
};

/// The vertices of the graph's mesh, 3 x V [mm], when its nodes have moved.
/// \throws InvalidInput unless there is one motion a node.
[[nodiscard]] Eigen::Matrix3Xd deformed_vertices(const DeformationGraph& graph,
                                                 std::span<const Eigen::Isometry3d> node_motions);

}  // namespace palpate::geometry
