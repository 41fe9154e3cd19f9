// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"

namespace palpate::geometry {

/// A surface that resists deformation except rigid motion (Sorkine and Alexa 2007) and is attracted
/// to target positions.
class ElasticSurface {
 public:
  /// \param rest    the undeformed surface
  /// \param pinned  places on it that are attracted to points, one column of weights each
  ElasticSurface(const TriangleMesh& rest, const std::vector<SurfacePoint>& pinned);

  /// Minimises sum_v a_v weights_v |x_v - targets_v|^2 + mean of |x(pinned) - pins|^2 + length^2
  /// E(x), where a are the vertices' shares of the area and E is the elastic energy divided by the
  /// area. Does some steps from `positions`, which it updates. `weights` are those of the last
  /// `factorise`.
  void relax(const Eigen::Matrix3Xd& targets, const Eigen::Matrix3Xd& pins,
             Eigen::Matrix3Xd& positions) const;

  /// \throws SolverError if the equations are singular.
  void factorise(double length, const Eigen::VectorXd& weights);

 private:
  struct Edge {
    int a, b;
    double weight;
  };

  Eigen::Matrix3Xd rest_;
  std::vector<Edge> edges_;
  Eigen::VectorXd shares_;            // V, of the area
  Eigen::SparseMatrix<double> pins_;  // V x L, barycentric
  Eigen::VectorXd pull_;              // V, shares times weights
  double stiffness_ = 0;              // length^2
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace palpate::geometry
