// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "convex_fit.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "convex_solver.h"
#include "convex_start.h"

namespace palpate::haptics {
namespace {

// Parameters of a base: weight, epsilon, and three of its centre, or of offset and direction.
constexpr int kParameters = 5;
// Bases at the start over those that remain at most, as a factor.
constexpr double kSurplus = 1.3;
// Iterations: with all bases, twice; after each removal; at the end.
constexpr int kFirstIterations = 15;
constexpr int kRemovalIterations = 8;
constexpr int kLastIterations = 40;
// chi^2 over that of all bases up to which fewer explain the samples as well, if it is what noise
// makes: a sixth more deviation.
constexpr double kAsGood = 1.35;
// Squared length of a whitened error that makes an outlier: noise exceeds it once in 10^10 samples.
// More than this part of the samples are no outliers but what the field cannot follow.
constexpr double kOutlier = 50;
constexpr double kMaxOutliers = 0.1;

double mean_squared_error(const WhitenedProblem& problem, const ForceField& field) {
  double sum = 0;
  for (Eigen::Index i = 0; i < problem.size(); ++i) {
    sum += (force(field, problem.displacements().col(i)) - problem.forces().col(i)).squaredNorm();
  }
  return sum / static_cast<double>(problem.size());
}

double degrees_of_freedom(const WhitenedProblem& problem, std::size_t bases) {
  return static_cast<double>(3 * problem.size()) - kParameters * static_cast<double>(bases);
}

// Looks at the errors anew after the field has changed much.
void look_again(WhitenedProblem& problem, const ForceField& field) {
  problem.whiten(field);
  problem.adapt_spread(field);
}

// chi^2 per degree of freedom, without the outliers as long as they are few.
void count_errors(const WhitenedProblem& problem, ConvexFit& fit) {
  const Eigen::VectorXd errors = problem.residuals(fit.field);
  double all = 0, inside = 0;
  for (Eigen::Index i = 0; i < problem.size(); ++i) {
    const double square = errors.segment<3>(3 * i).squaredNorm();
    all += square;
    if (square > kOutlier) {
      ++fit.outliers;
    } else {
      inside += square;
    }
  }
  const double few = kMaxOutliers * static_cast<double>(problem.size());
  const bool robust = fit.outliers <= few;
  const double degrees = degrees_of_freedom(problem, fit.field.bases.size());
  fit.chi2 =
      robust ? inside / std::max(1.0, degrees - 3 * fit.outliers) : all / std::max(1.0, degrees);
}

class Pruning {
 public:
  Pruning(const WhitenedProblem& problem, double accuracy, ConvexFit& fit)
      : problem_(problem), accuracy_(accuracy), fit_(fit) {}

  /// Removes bases for as long as those that remain are accurate enough, or it pays.
  void run() {
    ForceField& field = fit_.field;
    double loss = improve(field, kRemovalIterations);
    noise_ = std::min(1.0, loss / std::max(1.0, degrees_of_freedom(problem_, field.bases.size())));
    while (field.bases.size() > 1) {
      ForceField fewer = field;
      remove_least(problem_, fewer);
      const double fewer_loss = improve(fewer, kRemovalIterations);
      if (!accept(fewer, loss, fewer_loss)) break;
      field = std::move(fewer);
      loss = fewer_loss;
    }
  }

 private:
  double improve(ForceField& field, int iterations) {
    const ConvexSolution solution = refine(problem_, iterations, field);
    fit_.iterations += solution.iterations;
    return solution.loss;
  }

  // Fewer bases are as good if what is left is accurate enough, if noise explains it as well as
  // that of all bases, or by the Bayesian information criterion.
  [[nodiscard]] bool accept(const ForceField& fewer, double loss, double fewer_loss) const {
    if (mean_squared_error(problem_, fewer) <= accuracy_ * accuracy_) return true;
    const double values = 3 * static_cast<double>(problem_.size());
    const double explained = std::min(1.0, kAsGood * noise_);
    return fewer_loss <= explained * degrees_of_freedom(problem_, fewer.bases.size()) ||
           fewer_loss - loss < noise_ * kParameters * std::log(values);
  }

  const WhitenedProblem& problem_;
  double accuracy_;
  ConvexFit& fit_;
  // Variance of the noise over what was assumed: where it is less, all bases together tell so.
  double noise_ = 1;
};

}  // namespace

ConvexFit fit_convex(const Eigen::Matrix3Xd& displacements, const Eigen::Matrix3Xd& forces,
                     const SampleNoise& noise, double accuracy, int max_bases) {
  WhitenedProblem problem(displacements, forces, noise);
  ConvexFit fit;
  const int start = static_cast<int>(std::ceil(kSurplus * max_bases));
  fit.field = convex_start(problem, start);
  look_again(problem, fit.field);
  while (static_cast<int>(fit.field.bases.size()) > max_bases) remove_least(problem, fit.field);
  for (int round = 0; round < 2; ++round) {
    fit.iterations += refine(problem, kFirstIterations, fit.field).iterations;
    look_again(problem, fit.field);
  }
  Pruning(problem, accuracy, fit).run();
  look_again(problem, fit.field);
  fit.iterations += refine(problem, kLastIterations, fit.field).iterations;
  std::erase_if(fit.field.bases, [](const Multiquadric& base) { return !(base.weight > 0); });

  problem.whiten(fit.field);
  count_errors(problem, fit);
  fit.mean_noise = problem.mean_noise();
  fit.condition = condition_number(problem, fit.field);
  return fit;
}

}  // namespace palpate::haptics
