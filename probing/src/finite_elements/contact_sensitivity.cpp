// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/contact_sensitivity.h"

#include <optional>

#include "finite_elements/krylov_solve.h"
#include "finite_elements/near_tangent.h"
#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

constexpr KrylovOptions kSolve{.tolerance = 1e-3, .max_products = 12};
constexpr double kLargestResidual = 1e-2;  // of the forces: beyond it there is no answer
constexpr int kAnswerProducts =
    6;  // of the tangent for an answer, beyond which it is factored again

}  // namespace

Eigen::MatrixXd answers_to(const ContactSystem& system, const EquilibriumOptions& options,
                           const PlaceFactors& place, WorkingFactors& working,
                           const ContactState& start, const ContactState& at,
                           const Eigen::MatrixXd& forces) {
  const ContactStep step{ContactGoal::force, at.force, false};
  const SystemForces here = system.forces(at.positions, at.tip, &start);
  if (!here.valid) throw SolverError("the equilibrium has inverted elements");
  const auto product = [&](const Eigen::VectorXd& motion) {
    return tangent_product(system, options.tip_radius, start, step, {at.positions, at.tip, here},
                           motion);
  };
  Eigen::MatrixXd result = Eigen::MatrixXd::Zero(forces.rows(), forces.cols());
  bool fresh = false;
  std::optional<NearTangent> tangent;
  const auto take_factors = [&] {
    tangent.emplace(system, place, working.valid ? working.factors : place.rest, here, step.goal);
  };
  const auto nearly_inverse = [&](const Eigen::VectorXd& missing) {
    return tangent->solve(missing);
  };
  take_factors();
  for (Eigen::Index k = 0; k < forces.cols(); ++k) {
    if (forces.col(k).isZero(0)) continue;
    KrylovResult solved = krylov_solve(product, nearly_inverse, forces.col(k), kSolve);
    if (!fresh && solved.products > kAnswerProducts) {
      factor_place(system, place, at.positions, working.factors);
      working.valid = true;
      fresh = true;
      take_factors();
      if (solved.residual > kSolve.tolerance)
        solved = krylov_solve(product, nearly_inverse, forces.col(k), kSolve);
    }
    if (!(solved.residual <= kLargestResidual) || !solved.solution.allFinite())
      throw SolverError("the equilibrium is not stable: its answer to small forces is not known");
    result.col(k) = solved.solution;
  }
  return result;
}

}  // namespace palpate::probing
