// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "deformation/elastic_surface.h"

#include <Eigen/Geometry>
#include <cstddef>
#include <map>
#include <utility>

#include "deformation/nearest_rotation.h"
#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"

namespace palpate::geometry {
namespace {

constexpr int kSteps = 3;  // alternations of rotations and positions; the caller iterates further

}  // namespace

ElasticSurface::ElasticSurface(const TriangleMesh& rest, const std::vector<SurfacePoint>& pinned)
    : rest_(rest.vertices), shares_(Eigen::VectorXd::Zero(rest.vertices.cols())) {
  std::map<std::pair<int, int>, double> cotangents;
  double area = 0;
  for (const auto& t : rest.triangles.colwise()) {
    for (int k = 0; k < 3; ++k) {
      const int i = t[k], j = t[(k + 1) % 3], tip = t[(k + 2) % 3];
      const Eigen::Vector3d a = rest_.col(i) - rest_.col(tip), b = rest_.col(j) - rest_.col(tip);
      const double twice_area = a.cross(b).norm();
      shares_[tip] += twice_area / 6;
      area += twice_area / 6;
      if (twice_area > 0) cotangents[std::minmax(i, j)] += a.dot(b) / twice_area / 2;
    }
  }
  shares_ /= area;
  // Give a vertex without triangles a share as well, so that the equations have a solution.
  shares_ = (shares_.array() > 0).select(shares_, 1 / static_cast<double>(shares_.size()));
  for (const auto& [edge, weight] : cotangents) {
    if (weight > 0) edges_.push_back({edge.first, edge.second, weight / area});
  }
  std::vector<Eigen::Triplet<double>> entries;
  for (std::size_t k = 0; k < pinned.size(); ++k) {
    for (int c = 0; c < 3; ++c) {
      entries.emplace_back(rest.triangles(c, pinned[k].triangle), static_cast<int>(k),
                           pinned[k].barycentric[c]);
    }
  }
  pins_.resize(rest_.cols(), static_cast<Eigen::Index>(pinned.size()));
  pins_.setFromTriplets(entries.begin(), entries.end());
}

void ElasticSurface::factorise(double length, const Eigen::VectorXd& weights) {
  stiffness_ = length * length;
  pull_ = shares_.cwiseProduct(weights);
  std::vector<Eigen::Triplet<double>> entries;
  for (Eigen::Index v = 0; v < rest_.cols(); ++v)
    entries.emplace_back(static_cast<int>(v), static_cast<int>(v), pull_[v]);
  for (const Edge& edge : edges_) {
    const double w = stiffness_ * edge.weight;
    entries.emplace_back(edge.a, edge.a, w);
    entries.emplace_back(edge.b, edge.b, w);
    entries.emplace_back(edge.a, edge.b, -w);
    entries.emplace_back(edge.b, edge.a, -w);
  }
  Eigen::SparseMatrix<double> matrix(rest_.cols(), rest_.cols());
  matrix.setFromTriplets(entries.begin(), entries.end());
  const double pin_weight = 1 / static_cast<double>(pins_.cols());
  matrix += Eigen::SparseMatrix<double>(pin_weight * pins_ * pins_.transpose());
  solver_.compute(matrix);
  if (solver_.info() != Eigen::Success) {
    throw SolverError(
        "map_surface: the equations of the elastic surface are singular; a vertex "
        "without a triangle of some area may be the reason (see repair_mesh)");
  }
}

void ElasticSurface::relax(const Eigen::Matrix3Xd& targets, const Eigen::Matrix3Xd& pins,
                           Eigen::Matrix3Xd& positions) const {
  const double pin_weight = 1 / static_cast<double>(pins_.cols());
  const Eigen::MatrixXd drawn =
      pull_.asDiagonal() * targets.transpose() + pin_weight * pins_ * pins.transpose();
  std::vector<Eigen::Matrix3d> turns(static_cast<std::size_t>(rest_.cols()));
  for (int step = 0; step < kSteps; ++step) {
    for (Eigen::Matrix3d& turn : turns) turn.setZero();
    for (const Edge& edge : edges_) {
      const Eigen::Matrix3d outer = edge.weight * (positions.col(edge.a) - positions.col(edge.b)) *
                                    (rest_.col(edge.a) - rest_.col(edge.b)).transpose();
      turns[static_cast<std::size_t>(edge.a)] += outer;
      turns[static_cast<std::size_t>(edge.b)] += outer;
    }
    parallel_for(turns.size(), [&](std::size_t v) { turns[v] = nearest_rotation(turns[v]); });
    Eigen::MatrixXd right = drawn;
    for (const Edge& edge : edges_) {
      const Eigen::RowVector3d pull =
          stiffness_ * edge.weight / 2 *
          ((turns[static_cast<std::size_t>(edge.a)] + turns[static_cast<std::size_t>(edge.b)]) *
           (rest_.col(edge.a) - rest_.col(edge.b)))
              .transpose();
      right.row(edge.a) += pull;
      right.row(edge.b) -= pull;
    }
    positions = solver_.solve(right).transpose();
  }
}

}  // namespace palpate::geometry
