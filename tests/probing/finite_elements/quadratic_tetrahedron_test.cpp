// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/quadratic_tetrahedron.h"

#include <gtest/gtest.h>

#include <random>

namespace palpate::probing {
namespace {

const Hyperelastic kNearlyIncompressible{
    .shear_modulus = 0.7, .bulk_modulus = 40, .mooney_share = 0.3};

ElementNodes straight_element() {
  ElementNodes nodes;
  nodes.leftCols<4>() << 0, 2, 0.3, 0.2, 0, 0.1, 1.5, 0.4, 0, -0.2, 0.1, 1.8;
  constexpr int kEdges[6][2] = {{0, 1}, {1, 2}, {0, 2}, {0, 3}, {1, 3}, {2, 3}};
  for (int e = 0; e < 6; ++e)
    nodes.col(4 + e) = (nodes.col(kEdges[e][0]) + nodes.col(kEdges[e][1])) / 2;
  return nodes;
}

ElementNodes moved(const ElementNodes& nodes, double by) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-by, by);
  return nodes.unaryExpr([&](double v) { return v + uniform(random); });
}

TEST(QuadraticTetrahedron, ForceIsTheDerivativeOfTheEnergy) {
  constexpr double kStep = 1e-5, kTruncation = 1e-7;
  const TetrahedronPoints points = tetrahedron_points(straight_element());
  const ElementNodes at = moved(straight_element(), 0.08);
  const ElementForce force = element_force(points, kNearlyIncompressible, at);
  ASSERT_TRUE(force.valid);
  for (int k = 0; k < 30; ++k) {
    ElementNodes more = at, less = at;
    more(k) += kStep;
    less(k) -= kStep;
    EXPECT_NEAR(force.force(k),
                (element_force(points, kNearlyIncompressible, more).energy -
                 element_force(points, kNearlyIncompressible, less).energy) /
                    (2 * kStep),
                kTruncation);
  }
}

TEST(QuadraticTetrahedron, TangentIsTheDerivativeOfTheForce) {
  constexpr double kStep = 1e-5, kTruncation = 1e-6;
  const TetrahedronPoints points = tetrahedron_points(straight_element());
  const ElementNodes at = moved(straight_element(), 0.08);
  const ElementMatrix tangent = element_tangent(points, kNearlyIncompressible, at);
  EXPECT_LT((tangent - tangent.transpose()).norm(), 1e-13 * tangent.norm());
  for (int k = 0; k < 30; ++k) {
    ElementNodes more = at, less = at;
    more(k) += kStep;
    less(k) -= kStep;
    const ElementNodes expected = (element_force(points, kNearlyIncompressible, more).force -
                                   element_force(points, kNearlyIncompressible, less).force) /
                                  (2 * kStep);
    for (int i = 0; i < 30; ++i) EXPECT_NEAR(tangent(i, k), expected(i), kTruncation);
  }
}

TEST(QuadraticTetrahedron, KnowsAnInvertedElement) {
  ElementNodes flat = straight_element();
  EXPECT_GT(shape_quality(flat), 0.9);
  flat.col(3) = -flat.col(3);
  EXPECT_LT(shape_quality(flat), 0);
  ElementNodes bent = straight_element();
  bent.col(4) += Eigen::Vector3d(0, 1.5, 0);  // only the middle of an edge
  EXPECT_LT(shape_quality(bent), 0);
  EXPECT_FALSE(
      element_force(tetrahedron_points(straight_element()), kNearlyIncompressible, flat).valid);
}

}  // namespace
}  // namespace palpate::probing
