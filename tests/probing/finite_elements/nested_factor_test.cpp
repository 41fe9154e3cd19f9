// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/nested_factor.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <set>

#include "finite_elements/finite_element_tools.h"

namespace palpate::probing {
namespace {

struct SmallSolid {
  NestedProblem problem;
  ElementTangents tangents;
  Eigen::MatrixXd dense;  // with ones on the diagonal at fixed nodes
};

SmallSolid small_solid() {
  const FiniteElementMesh mesh = box_mesh({0, 2, 4, 6, 8}, {0, 2, 4, 6}, {0, 2, 4});
  SmallSolid solid;
  NestedProblem& problem = solid.problem;
  problem.nodes = mesh.nodes;
  problem.elements = mesh.elements;
  problem.fixed.assign(static_cast<std::size_t>(mesh.nodes.cols()), false);
  for (int n = 0; n < mesh.nodes.cols(); ++n) {
    const Eigen::Vector3d at = mesh.nodes.col(n);
    problem.fixed[static_cast<std::size_t>(n)] = at.z() == 4;
    if (at.z() == 0 && at.head<2>().norm() < 3.5) problem.root.push_back(n);
  }
  solid.tangents = [mesh](int e) {
    const ElementNodes nodes = element_nodes(mesh, mesh.nodes, e);
    return element_tangent(tetrahedron_points(nodes), {}, nodes);
  };
  solid.dense.setZero(mesh.nodes.size(), mesh.nodes.size());
  for (int e = 0; e < mesh.elements.cols(); ++e) {
    const ElementMatrix tangent = solid.tangents(e);
    for (int a = 0; a < 10; ++a)
      for (int b = 0; b < 10; ++b)
        solid.dense.block<3, 3>(3 * mesh.elements(a, e), 3 * mesh.elements(b, e)) +=
            tangent.block<3, 3>(3 * a, 3 * b);
  }
  for (int n = 0; n < mesh.nodes.cols(); ++n) {
    if (!problem.fixed[static_cast<std::size_t>(n)]) continue;
    solid.dense.middleRows<3>(3 * n).setZero();
    solid.dense.middleCols<3>(3 * n).setZero();
    solid.dense.block<3, 3>(3 * n, 3 * n).setIdentity();
  }
  return solid;
}

Eigen::VectorXd solved_by_fronts(const SmallSolid& solid, const FrontTree& tree,
                                 const NestedFactors& factors, Eigen::VectorXd vector) {
  substitute_forward(tree, factors, vector);
  const std::vector<int>& root = solid.problem.root;
  Eigen::VectorXd right(3 * static_cast<Eigen::Index>(root.size()));
  for (std::size_t k = 0; k < root.size(); ++k)
    right.segment<3>(static_cast<Eigen::Index>(3 * k)) = vector.segment<3>(3 * root[k]);
  if (!root.empty()) right = factors.fronts.back().update.partialPivLu().solve(right).eval();
  for (std::size_t k = 0; k < root.size(); ++k)
    vector.segment<3>(3 * root[k]) = right.segment<3>(static_cast<Eigen::Index>(3 * k));
  substitute_backward(tree, factors, vector);
  return vector;
}

TEST(NestedFactor, SolvesAsADenseFactorDoes) {
  SmallSolid solid = small_solid();
  Eigen::VectorXd right = Eigen::VectorXd::LinSpaced(solid.dense.rows(), -1, 1);
  for (int n = 0; n < solid.problem.nodes.cols(); ++n)
    if (solid.problem.fixed[static_cast<std::size_t>(n)]) right.segment<3>(3 * n).setZero();
  const Eigen::VectorXd expected = solid.dense.partialPivLu().solve(right);
  for (const bool with_root : {true, false}) {
    if (!with_root) solid.problem.root.clear();
    const FrontTree tree = nested_dissection(solid.problem);
    NestedFactors factors;
    factor_fronts(tree, solid.problem, solid.tangents, factors);
    EXPECT_EQ(factors.shift, 0);
    const Eigen::VectorXd solved = solved_by_fronts(solid, tree, factors, right);
    EXPECT_LT((solved - expected).norm(), 1e-11 * expected.norm());
    // Again in place, as when positions have changed.
    factor_fronts(tree, solid.problem, solid.tangents, factors);
    EXPECT_EQ(solved_by_fronts(solid, tree, factors, right), solved);
  }
}

TEST(NestedFactor, EliminatesEachFreeNodeAndAssemblesEachElementOnce) {
  const SmallSolid solid = small_solid();
  const FrontTree tree = nested_dissection(solid.problem);
  std::multiset<int> nodes, elements;
  for (const FrontTree::Front& front : tree.fronts) {
    nodes.insert(front.own.begin(), front.own.end());
    elements.insert(front.elements.begin(), front.elements.end());
  }
  for (int n = 0; n < solid.problem.nodes.cols(); ++n)
    EXPECT_EQ(nodes.count(n), solid.problem.fixed[static_cast<std::size_t>(n)] ? 0u : 1u);
  for (int e = 0; e < solid.problem.elements.cols(); ++e) EXPECT_EQ(elements.count(e), 1u);
  EXPECT_EQ(tree.fronts.back().own, solid.problem.root);
}

TEST(NestedFactor, ShiftsAMatrixThatIsNotPositiveDefinite) {
  const SmallSolid solid = small_solid();
  const FrontTree tree = nested_dissection(solid.problem);
  NestedFactors factors;
  factor_fronts(
      tree, solid.problem, [&](int e) { return ElementMatrix(-solid.tangents(e)); }, factors);
  EXPECT_GT(factors.shift, 0);
  EXPECT_TRUE(solved_by_fronts(solid, tree, factors, Eigen::VectorXd::Ones(solid.dense.rows()))
                  .allFinite());
}

}  // namespace
}  // namespace palpate::probing
