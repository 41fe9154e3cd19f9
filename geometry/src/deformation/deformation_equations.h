// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <span>
#include <vector>

#include "deformation/rest_links.h"
#include "palpate/geometry/deformation_graph.h"

namespace palpate::geometry {

/// A vertex attracted to a plane.
struct PlanePair {
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< unit, unless the distance is not a length
  double distance = 0;                               ///< [mm] of the vertex above the plane
  double weight = 0;                                 ///< >= 0; 0 if unused
};

/// Gauss-Newton steps for the motions of a graph's nodes. The sparsity pattern follows from the
/// graph's edges and is analysed once.
class DeformationEquations {
 public:
  /// \param samples  vertices that can be attracted to planes; one may appear several times
  /// \param unit  number of samples of weight 1 that together weigh as much as the number of nodes
  DeformationEquations(const DeformationGraph& graph, std::vector<int> samples, std::size_t unit);

  [[nodiscard]] std::span<const int> samples() const { return samples_; }

  /// The scale of the whole surface that explains its motions best, at most by kMostScale.
  [[nodiscard]] double scale_of(const std::vector<Eigen::Isometry3d>& motions) const;

  /// Moves the nodes by one step. `pairs`: one per sample. Returns the motion of the nodes [mm]
  /// (RMS), with rotations measured at the spacing of the nodes.
  /// \throws SolverError if the equations cannot be solved.
  /// \param anchors  3 x N [mm], where the nodes are held by kAnchor of the stiffness
  /// \param hold strength with which nodes are held at their places in the graph
  /// \param scale of the links at rest; is also changed if it is free
  double step(std::span<const PlanePair> pairs, double stiffness, const Eigen::Matrix3Xd& anchors,
              double hold, bool scale_is_free, double& scale,
              std::vector<Eigen::Isometry3d>& motions);

  /// Change of the solution that a change of the data of the equations causes.
  struct Response {
    Eigen::VectorXd moves;  ///< 6N [mm]: rotation of each node times the spacing, translation
    double scale = 0;       ///< change of the scale
  };

  /// Prepares the responses at a solution; the equations are then without anchors and `hold`.
  /// \param damping of all moves, relative to the weight of the data; > 0
  /// \return true if the equations can be solved; otherwise there are no responses
  bool linearize(std::span<const PlanePair> pairs, double stiffness, double damping,
                 bool scale_is_free, double scale, const std::vector<Eigen::Isometry3d>& motions);

  /// Response to errors of the distances of the first pairs, [mm].
  [[nodiscard]] Response response_to_distances(std::span<const PlanePair> pairs,
                                               std::span<const double> errors) const;

  /// Response to links that are longer at rest, by E fractions of their length.
  [[nodiscard]] Response response_to_links(const Eigen::VectorXd& stretch) const;

  /// Response to moves of the places at which the damping holds the nodes.
  [[nodiscard]] Response response_to_moves(const Eigen::VectorXd& moves) const;

  /// Response to the removal of the pull of the scale towards 1.
  [[nodiscard]] Response response_to_scale() const;

  /// The links at rest as they lie in the deformed surface, 3 x E [mm].
  [[nodiscard]] const Eigen::Matrix3Xd& arms() const { return at_.arms; }

 private:
  using Vector6d = Eigen::Vector<double, 6>;
  using Matrix6d = Eigen::Matrix<double, 6, 6>;
  /// Blocks of the lower triangle: first the N diagonal ones, then one per edge (row b, column a).
  struct Sums {
    std::vector<Matrix6d> blocks;
    Eigen::VectorXd gradient;
    /// Derivatives of half the energy of stretch: with respect to the scale, once and twice, and of
    /// that with respect to the nodes.
    double of_scale = 0;
    double of_scale_twice = 0;
    Eigen::VectorXd of_scale_and_nodes;
  };

  [[nodiscard]] Sums sum_of_planes(std::span<const PlanePair> pairs,
                                   const std::vector<Eigen::Isometry3d>& motions) const;
  void add_stretch(double stiffness, double scale, const Eigen::Matrix3Xd& links,
                   const std::vector<Eigen::Isometry3d>& motions, Sums& sums) const;
  void add_stiffness(double stiffness, const Eigen::Matrix3Xd& links,
                     const std::vector<Eigen::Isometry3d>& motions, Sums& sums) const;
  void add_anchors(double weight, const Eigen::Matrix3Xd& anchors,
                   const std::vector<Eigen::Isometry3d>& motions, Sums& sums) const;
  void fill_matrix(const Sums& sums, double damping);

  /// Data that `linearize` prepares.
  struct Linearization {
    std::vector<Eigen::Isometry3d> motions;
    Eigen::Matrix3Xd arms;
    double stiffness = 0;
    double damping = 0;
    double scale = 1;
    double scale_held = 0;  ///< second derivative of the term that pulls the scale to 1
    double scale_left = 0;  ///< second derivative by the scale if the nodes follow; 0: not free
    Eigen::VectorXd of_scale_and_nodes;
    Eigen::VectorXd moves_per_scale;
  };

  [[nodiscard]] Vector6d derivative(int vertex, int influence, const Eigen::Vector3d& normal,
                                    const std::vector<Eigen::Isometry3d>& motions) const;
  [[nodiscard]] double left_of_scale(const Sums& sums,
                                     const Eigen::VectorXd& moves_per_scale) const;
  [[nodiscard]] Response solved(const Eigen::VectorXd& force, double of_scale) const;

  const DeformationGraph& graph_;
  std::vector<int> samples_;
  double scale_;                        ///< of the weights
  std::vector<int> pair_blocks_;        ///< the blocks (i, j), i < j, of each sample, consecutively
  std::vector<int> first_edge_;         ///< N + 1, start of each node's edges to higher nodes
  Eigen::SparseMatrix<double> matrix_;  ///< lower triangle
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
  Linearization at_;
};

}  // namespace palpate::geometry
