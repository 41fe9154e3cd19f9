// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>
#include <memory>
#include <vector>

#include "finite_elements/quadratic_tetrahedron.h"

// Cholesky factors of a finite-element matrix by nested dissection in space, with dense fronts
// (multifrontal: Duff and Reid 1983). The last front, the root, holds the surface about a contact
// and is assembled only, so that the contact can be added to it at little cost. Written for this
// purpose since the solver must be safe in threads and the same on every processor.
namespace palpate::probing {

struct NestedProblem {
  Eigen::Matrix3Xd nodes;  // [mm] places, by which nodes are divided
  Eigen::Matrix<int, 10, Eigen::Dynamic> elements;
  std::vector<bool> fixed;  // nodes without unknowns
  std::vector<int> root;    // nodes that stay in the root, in its order
};

// The order of elimination; depends on the mesh alone.
struct FrontTree {
  struct Front {
    std::vector<int> own, border;  // nodes that are eliminated here, and those that this changes
    std::vector<int> children;     // fronts
    std::vector<int> elements;     // assembled here
  };
  std::vector<Front> fronts;  // children before parents; the last is the root
  [[nodiscard]] int root_front() const { return static_cast<int>(fronts.size()) - 1; }
};
[[nodiscard]] FrontTree nested_dissection(const NestedProblem& problem);

using ElementTangents = std::function<ElementMatrix(int element)>;

struct FrontFactor {
  Eigen::MatrixXd columns;  // of the own unknowns: Cholesky factor above, coupling below
  Eigen::MatrixXd update;   // of the border, lower half: the Schur complement's part
};

struct NestedFactors {
  std::vector<FrontFactor> fronts;
  double shift = 0;  // [N/mm] added to the diagonal of fronts that were not positive definite
};

// Factors all fronts. The last, the root, is assembled only: its update is the Schur complement of
// all others, without the tip.
void factor_fronts(const FrontTree& tree, const NestedProblem& problem,
                   const ElementTangents& tangents, NestedFactors& factors);

// Forward and backward substitution through the fronts before the root, in place on a vector with
// three entries a node.
void substitute_forward(const FrontTree& tree, const NestedFactors& factors,
                        Eigen::VectorXd& vector);
void substitute_backward(const FrontTree& tree, const NestedFactors& factors,
                         Eigen::VectorXd& vector);

}  // namespace palpate::probing
