// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "identify/mesh_study.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "identify/pair_selection.h"
#include "palpate/core/error.h"

namespace palpate::haptics {

MeshStudy study_mesh(const probing::FiniteElementObject& object,
                     std::span<const probing::Contact> contacts, const std::vector<Pair>& pairs,
                     std::size_t most, const EquilibriumDone& done) {
  const std::vector<std::size_t> indices = representative_pairs(pairs, contacts, most);
  const std::vector<Pair> repeated = chosen_pairs(pairs, indices);
  MeshStudy result;
  try {
    const auto given = solid_displacements(object, contacts, repeated, done);
    const auto finer =
        solid_displacements({refined(object.body), object.options}, contacts, repeated, done);
    for (std::size_t k = 0; k < indices.size(); ++k) {
      if (!given[k] || !finer[k]) continue;
      result.pairs.push_back(indices[k]);
      result.difference.push_back(*finer[k] - *given[k]);
    }
  } catch (const SolverError&) {  // the finer solid has no equilibrium at rest
    return {};
  }
  return result;
}

double mesh_scatter(const MeshStudy& study, const std::vector<Pair>& pairs) {
  if (study.pairs.empty()) return 0;
  // Of differences d and displacements u, |d - f u|^2 / |u|^2 with the best common factor f.
  double common = 0, squares = 0;
  for (std::size_t k = 0; k < study.pairs.size(); ++k) {
    const Eigen::Vector3d& displacement = pairs[study.pairs[k]].displacement;
    common += study.difference[k].dot(displacement) / displacement.squaredNorm();
    squares += study.difference[k].squaredNorm() / displacement.squaredNorm();
  }
  const auto count = static_cast<double>(study.pairs.size());
  return std::sqrt(std::max(squares - common * common / count, 0.0) / (3 * count));
}

Eigen::VectorXd mesh_shift(const MeshStudy& study, const std::vector<Pair>& pairs,
                           const LawEstimate& found, const std::vector<bool>& free,
                           Eigen::Index regions) {
  // Usual errors of displacements on a mesh, of their length: what these pairs do not determine
  // beyond them stays as it is.
  constexpr double kUsual = 0.03;
  // Usual difference of the shifts of regions from their common one.
  constexpr double kUsualDifference = 0.1;
  const Eigen::Index count = found.parameters.size();
  // The columns are how shifts of all shear moduli in common, and then of each parameter, act.
  Eigen::MatrixXd directions = Eigen::MatrixXd::Zero(count, 1 + count);
  directions.col(0).head(regions).setOnes();
  for (Eigen::Index k = 0; k < count; ++k)
    if (free[static_cast<std::size_t>(k)])
      directions(k, 1 + k) = k < regions ? kUsualDifference : 1;
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(1 + count, 1 + count);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(1 + count);
  for (std::size_t k = 0; k < study.pairs.size(); ++k) {
    const std::size_t i = study.pairs[k];
    const double deviation = kUsual * pairs[i].displacement.norm();
    const Eigen::MatrixXd rows = found.predictions[i].by_parameters * directions / deviation;
    matrix += rows.transpose() * rows;
    right += rows.transpose() * study.difference[k] / deviation;
  }
  return directions * matrix.llt().solve(right);
}

}  // namespace palpate::haptics
