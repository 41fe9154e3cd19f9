// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <span>
#include <vector>

#include "palpate/geometry/deformation_graph.h"

namespace palpate::geometry {

/// A vertex drawn to a plane.
struct PlanePair {
  Eigen::Vector3d normal;  ///< unit
  double distance;         ///< [mm] of the vertex above the plane
  double weight;           ///< >= 0; 0: left out
};

/// Gauss-Newton steps of the motions of a graph's nodes. The pattern of the equations is that of
/// the graph's edges, analysed once.
class DeformationEquations {
 public:
  /// \param samples  vertices that can be drawn to planes
  DeformationEquations(const DeformationGraph& graph, std::vector<int> samples);

  [[nodiscard]] std::span<const int> samples() const { return samples_; }

  /// Moves the nodes by one step. `pairs`: one a sample. The weight of the planes is divided so
  /// that all samples together would weigh as much as there are nodes. Returns the largest move of
  /// a node [mm], turns at the spacing of the nodes.
  /// \throws SolverError if the equations cannot be solved.
  /// \param anchors  3 x N [mm], where the nodes are held by kAnchor of the stiffness
  double step(std::span<const PlanePair> pairs, double stiffness, const Eigen::Matrix3Xd& anchors,
              std::vector<Eigen::Isometry3d>& motions);

 private:
  using Vector6d = Eigen::Vector<double, 6>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  /// Blocks of the lower triangle: first the N on the diagonal, then one an edge (row b, column a).
  struct Sums {
    std::vector<Matrix6d> blocks;
    Eigen::VectorXd gradient;
  };

  [[nodiscard]] Sums sum_of_planes(std::span<const PlanePair> pairs,
                                   const std::vector<Eigen::Isometry3d>& motions) const;
  void add_stiffness(double stiffness, const std::vector<Eigen::Isometry3d>& motions,
                     Sums& sums) const;
  void add_anchors(double weight, const Eigen::Matrix3Xd& anchors,
                   const std::vector<Eigen::Isometry3d>& motions, Sums& sums) const;
  void fill_matrix(const Sums& sums);

  const DeformationGraph& graph_;
  std::vector<int> samples_;
  std::vector<int> pair_blocks_;        ///< a sample's blocks (i, j), i < j, one after the other
  std::vector<int> first_edge_;         ///< N + 1, of each node's edges to higher nodes
  Eigen::SparseMatrix<double> matrix_;  ///< lower triangle
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace palpate::geometry
