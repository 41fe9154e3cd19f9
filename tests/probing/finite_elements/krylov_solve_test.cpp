// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/krylov_solve.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <limits>

namespace palpate::probing {
namespace {

constexpr int kUnknowns = 12;

// Not symmetric; all eigenvalues lie to the right of zero.
Eigen::MatrixXd example_matrix() {
  Eigen::MatrixXd a(kUnknowns, kUnknowns);
  for (int i = 0; i < kUnknowns; ++i)
    for (int j = 0; j < kUnknowns; ++j)
      a(i, j) = (i == j ? 4.0 + i : 0) + 1.0 / (1 + i + 2 * j) - (j == i + 1 ? 2 : 0);
  return a;
}

LinearMap map_of(const Eigen::MatrixXd& matrix) {
  return [matrix](const Eigen::VectorXd& v) { return Eigen::VectorXd(matrix * v); };
}

const Eigen::VectorXd kRight = Eigen::VectorXd::LinSpaced(kUnknowns, -1, 2);

TEST(KrylovSolve, NeedsAsManyProductsAsUnknownsAtMost) {
  const Eigen::MatrixXd a = example_matrix();
  const KrylovResult found =
      krylov_solve(map_of(a), map_of(Eigen::MatrixXd::Identity(kUnknowns, kUnknowns)), kRight,
                   {.tolerance = 1e-12, .max_products = kUnknowns});
  EXPECT_LE(found.products, kUnknowns);
  EXPECT_LT((found.solution - a.partialPivLu().solve(kRight)).norm(), 1e-10);
}

TEST(KrylovSolve, NeedsOneProductWithTheInverse) {
  const Eigen::MatrixXd a = example_matrix();
  const KrylovResult found =
      krylov_solve(map_of(a), map_of(a.inverse()), kRight, {.tolerance = 1e-10});
  EXPECT_EQ(found.products, 1);
  EXPECT_LT((a * found.solution - kRight).norm(), 1e-10 * kRight.norm());
}

TEST(KrylovSolve, StopsAfterTheAllowedProductsAndTellsTheResidual) {
  const Eigen::MatrixXd a = example_matrix();
  double before = 1;
  for (const int products : {1, 2, 4}) {
    const KrylovResult found =
        krylov_solve(map_of(a), map_of(Eigen::MatrixXd::Identity(kUnknowns, kUnknowns)), kRight,
                     {.tolerance = 1e-12, .max_products = products});
    EXPECT_EQ(found.products, products);
    EXPECT_NEAR(found.residual, (kRight - a * found.solution).norm() / kRight.norm(), 1e-12);
    EXPECT_LT(found.residual, before);
    before = found.residual;
  }
}

TEST(KrylovSolve, HasNothingToDoWithoutARightSide) {
  const KrylovResult found = krylov_solve(map_of(example_matrix()), map_of(example_matrix()),
                                          Eigen::VectorXd::Zero(kUnknowns), {});
  EXPECT_EQ(found.solution, Eigen::VectorXd::Zero(kUnknowns));
  EXPECT_EQ(found.products, 0);
}

TEST(KrylovSolve, KeepsWhatItHasWhenAProductIsNotFinite) {
  const Eigen::MatrixXd a = example_matrix();
  int calls = 0;
  const LinearMap breaks = [&](const Eigen::VectorXd& v) {
    Eigen::VectorXd result = a * v;
    if (++calls == 3) result[0] = std::numeric_limits<double>::quiet_NaN();
    return result;
  };
  const KrylovResult found =
      krylov_solve(breaks, map_of(Eigen::MatrixXd::Identity(kUnknowns, kUnknowns)), kRight,
                   {.tolerance = 1e-12});
  EXPECT_EQ(found.products, 3);
  EXPECT_NEAR(found.residual, (kRight - a * found.solution).norm() / kRight.norm(), 1e-12);
  EXPECT_LT(found.residual, 1);
}

}  // namespace
}  // namespace palpate::probing
