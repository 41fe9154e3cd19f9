// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "finite_elements/krylov_solve.h"

#include <Eigen/QR>
#include <utility>
#include <vector>

namespace palpate::probing {

KrylovResult krylov_solve(const LinearMap& product, const LinearMap& nearly_inverse,
                          const Eigen::VectorXd& right, const KrylovOptions& options) {
  KrylovResult result;
  result.solution = Eigen::VectorXd::Zero(right.size());
  const double size = right.norm();
  if (!(size > 0)) {
    result.residual = 0;
    return result;
  }
  // With V the orthonormal directions: A [steps] = V H.
  std::vector<Eigen::VectorXd> directions{right / size}, steps;
  Eigen::MatrixXd h = Eigen::MatrixXd::Zero(options.max_products + 1, options.max_products);
  Eigen::VectorXd shares;
  for (int k = 0; k < options.max_products; ++k) {
    Eigen::VectorXd step = nearly_inverse(directions.back());
    Eigen::VectorXd w = product(step);
    ++result.products;
    if (!w.allFinite()) break;
    for (int i = 0; i <= k; ++i) {
      h(i, k) = directions[static_cast<std::size_t>(i)].dot(w);
      w -= h(i, k) * directions[static_cast<std::size_t>(i)];
    }
    h(k + 1, k) = w.norm();
    steps.push_back(std::move(step));
    const auto part = h.topLeftCorner(k + 2, k + 1);
    const Eigen::VectorXd goal = size * Eigen::VectorXd::Unit(k + 2, 0);
    shares = part.colPivHouseholderQr().solve(goal);
    result.residual = (goal - part * shares).norm() / size;
    if (result.residual <= options.tolerance || !(h(k + 1, k) > 0)) break;
    directions.push_back(w / h(k + 1, k));
  }
  for (std::size_t k = 0; k < steps.size(); ++k)
    result.solution += shares[static_cast<Eigen::Index>(k)] * steps[k];
  return result;
}

}  // namespace palpate::probing
