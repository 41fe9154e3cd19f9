// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "finite_elements/contact_system.h"
#include "finite_elements/nested_factor.h"

// Newton's method for the equilibrium of a solid and the tip. Its linear systems are solved by a
// Krylov method with old factors of the solid, to which the contact as it is now is added.
namespace palpate::probing {

// The matrix about a place of the surface: the order of elimination, and its factors at rest.
struct PlaceFactors {
  double reach = 0;  // [mm] from the place, of the faces that the tip may touch
  NestedProblem problem;
  FrontTree tree;
  NestedFactors rest;
  std::vector<int> root_index;  // of each node among those of the root; -1 elsewhere
};

// Orders the unknowns of a solid in equilibrium at `rest` [mm] about `centre` [mm]. A reach of 0
// gives a matrix for use without a tip. `rest` of the result is empty.
[[nodiscard]] PlaceFactors order_unknowns(const ContactSystem& system, const Eigen::Matrix3Xd& rest,
                                          const Eigen::Vector3d& centre, double reach);

// Factors the matrix at the given positions [mm]. See `factor_fronts`.
void factor_place(const ContactSystem& system, const PlaceFactors& place,
                  const Eigen::Matrix3Xd& positions, NestedFactors& factors);

// Returns true if the tip touches a face beyond the reach of the place.
[[nodiscard]] bool touches_beyond(const ContactSystem& system, const PlaceFactors& place,
                                  const SystemForces& forces);

enum class ContactGoal { force, position };

struct ContactStep {
  ContactGoal goal = ContactGoal::force;
  Eigen::Vector3d target = Eigen::Vector3d::Zero();  // [N] on the object, or [mm] of the tip
  bool exact = false;                                // factor the whole matrix in each iteration
};

struct ContactAttempt {
  Eigen::Matrix3Xd positions;  // 3 x N [mm]
  Eigen::Vector3d tip;         // [mm]
  SystemForces forces;
  ContactStop stop = ContactStop::not_converged;
  bool outgrown = false;  // the tip touched a face beyond the reach of the place
  int iterations = 0;
  int factorisations = 0;  // of the whole matrix
};

// The newest factors at a place. They are used, and replaced when linear systems need many products
// with them. If they are not valid, those at rest are used.
struct WorkingFactors {
  NestedFactors factors;
  bool valid = false;
};

// The start of Newton's method.
struct ContactGuess {
  Eigen::Matrix3Xd positions;  // 3 x N [mm]
  Eigen::Vector3d tip;         // [mm]
};

// Takes one load step from `start`, beginning at the guess if there is one. `modulus` [N/mm^2] is
// the largest Young's modulus of the solid.
[[nodiscard]] ContactAttempt attempt_step(const ContactSystem& system,
                                          const EquilibriumOptions& options, double modulus,
                                          const PlaceFactors& place, const ContactState& start,
                                          const ContactStep& step, WorkingFactors& working,
                                          const ContactGuess* guess);

}  // namespace palpate::probing
