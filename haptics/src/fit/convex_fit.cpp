// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/convex_fit.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <utility>

#include "fit/convex_solver.h"
#include "fit/convex_start.h"
#include "fit/field_objective.h"
#include "palpate/haptics/force_field_fit.h"

namespace palpate::haptics {
namespace {

// Efforts with all bases, used in turn until noise explains the errors. Only contacts that need
// nearly all bases reach the last one; few of theirs are removed.
constexpr Effort kFirstEfforts[] = {{8, 0.1}, {8, 0.1}, {20, 0.1}};
// Effort after each removal. A gain below 1 is not worthwhile, because noise alone changes the loss
// by more.
constexpr Effort kRemovalEffort = {8, 1};
constexpr Effort kLastEffort = {40, 0.1};
// Margin of `explained_loss` below the mean of chi^2, in standard deviations of chi^2. About a
// third of true fields lie below it.
constexpr double kMargin = 0.5;
// If the loss exceeds `explained_loss` by at most this factor, the field is refined with
// kCloserEffort before the decision.
constexpr double kNearlyExplained = 1.1;
constexpr Effort kCloserEffort = {20, 0.1};
// Fraction of the bases that is removed at once, while many are superfluous.
constexpr double kManyAtOnce = 0.2;
// Number of removals that are tried before removing one base counts as failed. Several are needed
// because the second-order estimate of the loss ranks them only roughly.
constexpr std::size_t kCandidates = 4;

double mean_squared_error(const WhitenedProblem& problem, const ForceField& field) {
  double sum = 0;
  for (Eigen::Index i = 0; i < problem.size(); ++i) {
    sum += (force(field, problem.displacements().col(i)) - problem.forces().col(i)).squaredNorm();
  }
  return sum / static_cast<double>(problem.size());
}

// The largest loss that noise explains, by the discrepancy principle. The margin below the mean n -
// p is needed because noise can be low by chance, which would hide that a field lacks a base.
double explained_loss(const WhitenedProblem& problem, std::size_t bases) {
  const double degrees =
      static_cast<double>(3 * problem.size()) - kBaseSize * static_cast<double>(bases);
  return degrees - kMargin * std::sqrt(2 * std::max(0.0, degrees));
}

// Updates the whitening and the spread after the field has changed much.
void look_again(WhitenedProblem& problem, const ForceField& field) {
  problem.whiten(field);
  problem.adapt_spread(field);
}

class Pruning {
 public:
  Pruning(const WhitenedProblem& problem, double accuracy, std::size_t max_bases, ConvexFit& fit)
      : problem_(problem), accuracy_(accuracy), max_bases_(max_bases), fit_(fit) {}

  /// Removes bases until at most `max_bases` are left, then further while `accept` allows it.
  void run() {
    loss_ = improve(fit_.field);
    while (remove_many()) {
    }
    while (remove_one()) {
    }
  }

 private:
  double improve(ForceField& field, const Effort& effort = kRemovalEffort) {
    const ConvexSolution solution = refine(problem_, effort, field);
    fit_.iterations += solution.iterations;
    return solution.loss;
  }

  [[nodiscard]] bool good(const ForceField& field, double loss) const {
    return loss <= explained_loss(problem_, field.bases.size()) ||
           mean_squared_error(problem_, field) <= accuracy_ * accuracy_;
  }

  // Accepts a field that is good. If noise explains none of the fields, it accepts a field that is
  // expected to predict better by Akaike's information criterion, chi^2 + 2 parameters, because the
  // variance of the noise is given.
  [[nodiscard]] bool accept(const ForceField& fewer, double loss) const {
    return good(fewer, loss) || loss - loss_ < 2 * kBaseSize;
  }

  void take(ForceField fewer, double loss) {
    fit_.field = std::move(fewer);
    loss_ = loss;
  }

  // Removes several bases without trying alternatives, to get rid of superfluous ones quickly.
  bool remove_many() {
    const auto many = static_cast<int>(kManyAtOnce * static_cast<double>(fit_.field.bases.size()));
    if (many < 2) return false;
    ForceField fewer = fit_.field;
    for (int removed = 0; removed < many; ++removed) {
      fewer = std::move(without_one(problem_, fewer, 1).front());
    }
    const double loss = improve(fewer);
    if (!good(fewer, loss)) return false;
    take(std::move(fewer), loss);
    return true;
  }

  // Takes the first candidate that is accepted. If there are still too many bases, it takes the
  // best one.
  bool remove_one() {
    if (fit_.field.bases.size() <= 1) return false;
    ForceField best;
    double best_loss = std::numeric_limits<double>::infinity();
    for (ForceField& fewer : without_one(problem_, fit_.field, kCandidates)) {
      const double loss = improve(fewer);
      if (loss < best_loss || best.bases.empty()) {
        best = std::move(fewer);
        best_loss = loss;
      }
      if (accept(best, best_loss)) {
        take(std::move(best), best_loss);
        return true;
      }
    }
    if (best_loss <= kNearlyExplained * explained_loss(problem_, best.bases.size())) {
      best_loss = improve(best, kCloserEffort);
    }
    if (fit_.field.bases.size() <= max_bases_ && !accept(best, best_loss)) return false;
    take(std::move(best), best_loss);
    return true;
  }

  const WhitenedProblem& problem_;
  double accuracy_;
  std::size_t max_bases_;
  ConvexFit& fit_;
  double loss_ = 0;
};

}  // namespace

ConvexFit fit_convex(WhitenedProblem problem, double accuracy, int max_bases) {
  // Start with many bases even if few are wanted: they find the places where bases are needed.
  const auto determined = static_cast<int>(3 * problem.size() / kBaseSize);
  const int start = std::max(1, std::min(determined, std::max(max_bases, kMaxConvexBases)));
  ConvexFit fit;
  fit.field = convex_start(problem, start);
  look_again(problem, fit.field);
  for (const Effort& effort : kFirstEfforts) {
    const ConvexSolution solution = refine(problem, effort, fit.field);
    fit.iterations += solution.iterations;
    look_again(problem, fit.field);
    if (solution.loss <= explained_loss(problem, fit.field.bases.size())) break;
  }
  Pruning(problem, accuracy, static_cast<std::size_t>(max_bases), fit).run();
  look_again(problem, fit.field);
  ForceField last = fit.field;
  fit.iterations += refine(problem, kLastEffort, last).iterations;
  // The last refinement reduces the whitened errors, but can increase the errors in N. Keep the
  // previous field if only that one meets `accuracy`.
  const double limit = accuracy * accuracy;
  if (mean_squared_error(problem, last) <= limit ||
      !(mean_squared_error(problem, fit.field) <= limit)) {
    fit.field = std::move(last);
  }
  std::erase_if(fit.field.bases, [](const Multiquadric& base) { return !(base.weight > 0); });

  problem.whiten(fit.field);
  fit.condition = condition_number(problem, fit.field);
  return fit;
}

}  // namespace palpate::haptics
