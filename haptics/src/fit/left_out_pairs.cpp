// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/left_out_pairs.h"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <vector>

#include "fit/convex_fit.h"
#include "palpate/core/quantile.h"

namespace palpate::haptics {

Eigen::VectorXd left_out_squares(const WhitenedProblem& problem, const LeftOutOptions& options) {
  Eigen::VectorXd squares(problem.size());
  for (Eigen::Index part = 0; part < kLeftOutParts; ++part) {
    std::vector<Eigen::Index> fitted;
    for (Eigen::Index i = 0; i < problem.size(); ++i) {
      if (i % kLeftOutParts != part) fitted.push_back(i);
    }
    const ConvexFit fit =
        fit_convex(WhitenedProblem(problem.displacements()(Eigen::all, fitted),
                                   problem.forces()(Eigen::all, fitted), options.noise),
                   options.accuracy, options.max_bases);
    for (Eigen::Index i = part; i < problem.size(); i += kLeftOutParts) {
      const Eigen::Vector3d error =
          force(fit.field, problem.displacements().col(i)) - problem.forces().col(i);
      squares[i] = (problem.whitening(i) * error).squaredNorm();
    }
  }
  return squares;
}

double typical_variance(const Eigen::VectorXd& squares) { return median(squares) / kMedianChi2; }

double capped_mean(const Eigen::VectorXd& squares, double most) {
  return squares.cwiseMin(most).mean();
}

double expected_growth(double parameters, double numbers) {
  const double left = 1 - parameters / numbers;
  return left > 0 ? 1 / (left * left) : std::numeric_limits<double>::infinity();
}

}  // namespace palpate::haptics
