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

// With all bases: one after the other until noise explains the errors. The last is for contacts
// that need all they can get; they are spared the removals.
constexpr Effort kFirstEfforts[] = {{8, 0.1}, {8, 0.1}, {20, 0.1}};
// After bases were removed. Noise alone moves the loss by more than what is not worthwhile here.
constexpr Effort kRemovalEffort = {8, 1};
constexpr Effort kLastEffort = {40, 0.1};
// Of chi^2 below its mean, in standard deviations of what noise makes: a third of true fields are.
constexpr double kMargin = 0.5;
// A field that misses what noise explains by this factor at most is worth a closer look.
constexpr double kNearlyExplained = 1.1;
constexpr Effort kCloserEffort = {20, 0.1};
// Part of the bases that is removed at once while many are left over.
constexpr double kManyAtOnce = 0.2;
// Bases that are tried for removal, one by one, before it counts as a failure: the order that the
// second order of the loss puts them in is not that of what can be reached without them.
constexpr std::size_t kCandidates = 4;

double mean_squared_error(const WhitenedProblem& problem, const ForceField& field) {
  double sum = 0;
  for (Eigen::Index i = 0; i < problem.size(); ++i) {
    sum += (force(field, problem.displacements().col(i)) - problem.forces().col(i)).squaredNorm();
  }
  return sum / static_cast<double>(problem.size());
}

// The largest loss that noise explains. The discrepancy principle, with a margin: n - p, what noise
// makes in the mean, would also let pass what lacks something where noise happens to be low.
double explained_loss(const WhitenedProblem& problem, std::size_t bases) {
  const double degrees =
      static_cast<double>(3 * problem.size()) - kBaseSize * static_cast<double>(bases);
  return degrees - kMargin * std::sqrt(2 * std::max(0.0, degrees));
}

// Looks at the errors anew after the field has changed much.
void look_again(WhitenedProblem& problem, const ForceField& field) {
  problem.whiten(field);
  problem.adapt_spread(field);
}

class Pruning {
 public:
  Pruning(const WhitenedProblem& problem, double accuracy, std::size_t max_bases, ConvexFit& fit)
      : problem_(problem), accuracy_(accuracy), max_bases_(max_bases), fit_(fit) {}

  /// Removes bases down to their number at most, and on for as long as those that remain are
  /// accurate enough, noise explains their errors, or it pays.
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

  // As good; or, where noise does not explain the errors of any, so none is the true one, better in
  // what it will predict: by Akaike's information criterion. The variance of the noise is given, so
  // that is chi^2 + 2 parameters.
  [[nodiscard]] bool accept(const ForceField& fewer, double loss) const {
    return good(fewer, loss) || loss - loss_ < 2 * kBaseSize;
  }

  void take(ForceField fewer, double loss) {
    fit_.field = std::move(fewer);
    loss_ = loss;
  }

  // Without looking for the best way down: what is left over goes fast.
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

  // The first of some that is accepted; the best of them where it has to be.
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
  // Also the way to few bases leads over more, which find the places where they are needed.
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
  // Weighted by their noise the errors have become smaller, but not so in N: what was just accurate
  // enough stays so.
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
