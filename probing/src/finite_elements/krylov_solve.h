// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <functional>

namespace palpate::probing {

using LinearMap = std::function<Eigen::VectorXd(const Eigen::VectorXd&)>;

struct KrylovOptions {
  double tolerance = 0.1;  // of the residual, over the norm of the right side
  int max_products = 10;
};

struct KrylovResult {
  Eigen::VectorXd solution;
  double residual = 1;  // over the norm of the right side
  int products = 0;     // with the matrix
};

// Solves A x = b by the generalised minimal residual method (Saad and Schultz 1986) without
// restarts: `product` gives A x, `nearly_inverse` a vector near A^-1 x. Stops without reaching the
// tolerance after the allowed products, or when a product is not finite.
[[nodiscard]] KrylovResult krylov_solve(const LinearMap& product, const LinearMap& nearly_inverse,
                                        const Eigen::VectorXd& right, const KrylovOptions& options);

}  // namespace palpate::probing
