// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "identify/mesh_study.h"

#include <Eigen/Cholesky>
#include <cmath>

#include "identify/pair_selection.h"
#include "palpate/core/error.h"

namespace palpate::haptics {

MeshStudy study_mesh(const probing::FiniteElementObject& object,
                     std::span<const probing::Contact> contacts, const std::vector<Pair>& pairs,
                     std::size_t most, const EquilibriumDone& done) {
  const std::vector<std::size_t> indices = largest_pairs(pairs, contacts, most);
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
  double sum = 0;
  for (std::size_t k = 0; k < study.pairs.size(); ++k)
    sum += study.difference[k].squaredNorm() / pairs[study.pairs[k]].displacement.squaredNorm();
  return std::sqrt(sum / (3 * static_cast<double>(study.pairs.size())));
}

Eigen::VectorXd mesh_shift(const MeshStudy& study, const std::vector<Pair>& pairs,
                           const LawEstimate& found, const std::vector<bool>& free) {
  // Usual errors of displacements on a mesh, of their length: parameters that these pairs do not
  // determine beyond them stay as they are.
  constexpr double kUsual = 0.03;
  const Eigen::Index count = found.parameters.size();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Identity(count, count);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  for (std::size_t k = 0; k < study.pairs.size(); ++k) {
    const std::size_t i = study.pairs[k];
    const double deviation = kUsual * pairs[i].displacement.norm();
    Eigen::MatrixXd rows = found.predictions[i].by_parameters / deviation;
    for (Eigen::Index p = 0; p < count; ++p)
      if (!free[static_cast<std::size_t>(p)]) rows.col(p).setZero();
    matrix += rows.transpose() * rows;
    right += rows.transpose() * study.difference[k] / deviation;
  }
  return matrix.llt().solve(right);
}

}  // namespace palpate::haptics
