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

double mesh_scatter(const MeshStudy& study, const std::vector<Pair>& pairs) {
  if (study.pairs.empty()) return 0;
  double common = 0, squares = 0;
  for (std::size_t k = 0; k < study.pairs.size(); ++k) {
    const Eigen::Vector3d& whole = pairs[study.pairs[k]].displacement;
    common += study.difference[k].dot(whole) / whole.squaredNorm();
    squares += study.difference[k].squaredNorm() / whole.squaredNorm();
  }
  const auto count = static_cast<double>(study.pairs.size());
  common /= count;
  return std::sqrt(std::max(squares / count - common * common, 0.0) / 3);
}

Eigen::VectorXd mesh_shift(const MeshStudy& study, const ParametricLaw& law,
                           const std::vector<Pair>& pairs, const LawEstimate& found,
                           const std::vector<bool>& free) {
  // The step of the estimate if the pairs were measured on the finer solid.
  Problem problem{.law = law, .pairs = chosen_pairs(pairs, study.pairs)};
  Weights weights{.whiten = {}, .shared_error = true};
  Predictions predictions;
  std::map<std::size_t, std::size_t> place;
  for (std::size_t k = 0; k < study.pairs.size(); ++k) place[study.pairs[k]] = k;
  for (std::size_t k = 0; k < study.pairs.size(); ++k) {
    const std::size_t i = study.pairs[k];
    const auto settled = place.find(pairs[i].settled);
    // A drag whose press has no equilibrium on the finer mesh counts as a press.
    problem.pairs[k].settled = settled == place.end() ? k : settled->second;
    problem.pairs[k].displacement = found.predictions[i].displacement + study.difference[k];
    weights.whiten.push_back(found.weights.whiten[i]);
    predictions.push_back(found.predictions[i]);
  }
  const NormalEquations normal = normal_equations(problem, weights, predictions);
  const Eigen::Index count = law.scale.size();
  // What these pairs do not determine stays as it is.
  Eigen::MatrixXd matrix = normal.matrix + Eigen::MatrixXd::Identity(count, count);
  Eigen::VectorXd right = -normal.gradient;
  for (Eigen::Index k = 0; k < count; ++k) {
    if (free[static_cast<std::size_t>(k)]) continue;
    matrix.row(k).setZero();
    matrix.col(k).setZero();
    matrix(k, k) = 1;
    right[k] = 0;
  }
  return matrix.llt().solve(right);
}

}  // namespace palpate::haptics
