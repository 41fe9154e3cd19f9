// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "identify/mesh_study.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

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

MeshScatter mesh_scatter(const MeshStudy& study, const std::vector<Pair>& pairs) {
  std::map<std::size_t, std::size_t> place;
  for (std::size_t k = 0; k < study.pairs.size(); ++k) place[study.pairs[k]] = k;
  struct Mean {
    double sum = 0, count = 0;
    [[nodiscard]] double root() const { return count > 0 ? std::sqrt(sum / count / 3) : 0; }
  };
  Mean press, drag;
  for (std::size_t k = 0; k < study.pairs.size(); ++k) {
    const std::size_t i = study.pairs[k], settled = pairs[i].settled;
    Eigen::Vector3d way = pairs[i].displacement, difference = study.difference[k];
    const auto held = place.find(settled);
    if (settled != i && held == place.end()) continue;
    if (settled != i) {
      way -= pairs[settled].displacement;
      difference -= study.difference[held->second];
    }
    Mean& mean = settled == i ? press : drag;
    mean.sum += difference.squaredNorm() / way.squaredNorm();
    mean.count += 1;
  }
  return {press.root(), drag.root()};
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
