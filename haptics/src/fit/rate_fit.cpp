// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/rate_fit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <boost/math/tools/minima.hpp>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "palpate/core/error.h"
#include "palpate/core/parallel_for.h"
#include "palpate/core/quantile.h"
#include "palpate/core/require.h"

namespace palpate::haptics {
namespace {

constexpr int kGrid = 16;                // times that are tried first, in even ratios
constexpr double kLongestTime = 3;       // the longest time, in lengths of the longest path
constexpr int kRefinements = 6;          // rounds in which each time is refined
constexpr int kTimeBits = 20;            // of a logarithm of a time
constexpr double kLeastTermGain = 0.02;  // of the RMS
constexpr double kErrorStep = 1e-3;      // of logarithms, for the derivatives of standard errors

/// All forces, and those of the fields at displacements, one below the other.
class RateProblem {
 public:
  explicit RateProblem(std::span<const RateRecord> records) : records_(records) {
    Eigen::Index rows = 0;
    for (const RateRecord& record : records) {
      first_.push_back(rows);
      rows += record.forces.size();
    }
    measured_.resize(rows);
    for (std::size_t i = 0; i < records.size(); ++i)
      measured_.segment(first_[i], records[i].forces.size()) = records[i].forces.reshaped();
    still_ = forces_at([](const RateRecord& record) { return record.path.displacements; });
  }

  [[nodiscard]] Eigen::VectorXd column(double time) const {
    return forces_at(
        [time](const RateRecord& record) { return displacement_ahead(record.path, time); });
  }
  [[nodiscard]] const Eigen::VectorXd& measured() const { return measured_; }
  [[nodiscard]] const Eigen::VectorXd& still() const { return still_; }

 private:
  template <typename Displacements>
  [[nodiscard]] Eigen::VectorXd forces_at(const Displacements& displacements) const {
    Eigen::VectorXd result(measured_.size());
    parallel_for(records_.size(), [&](std::size_t i) {
      const Eigen::Matrix3Xd at = displacements(records_[i]);
      for (Eigen::Index k = 0; k < at.cols(); ++k)
        result.segment<3>(first_[i] + 3 * k) = force(records_[i].field, at.col(k));
    });
    return result;
  }

  std::span<const RateRecord> records_;
  std::vector<Eigen::Index> first_;
  Eigen::VectorXd measured_, still_;
};

/// Times with their best weights: the first of the fields, then of each term.
struct WeightedTimes {
  std::vector<double> times;
  Eigen::VectorXd weights;
  double squares = std::numeric_limits<double>::infinity();  // [N^2] sum; infinite: not >= 0
};

WeightedTimes weigh(const RateProblem& problem, const std::vector<double>& times,
                    const std::vector<Eigen::VectorXd>& columns) {
  const auto count = static_cast<Eigen::Index>(1 + columns.size());
  Eigen::MatrixXd gram(count, count);
  Eigen::VectorXd right(count);
  const auto of = [&](Eigen::Index i) -> const Eigen::VectorXd& {
    return i == 0 ? problem.still() : columns[static_cast<std::size_t>(i - 1)];
  };
  for (Eigen::Index i = 0; i < count; ++i) {
    right[i] = of(i).dot(problem.measured());
    for (Eigen::Index j = 0; j <= i; ++j) gram(i, j) = gram(j, i) = of(i).dot(of(j));
  }
  WeightedTimes result{.times = times, .weights = gram.ldlt().solve(right)};
  if (!result.weights.allFinite() || !(result.weights.minCoeff() > 0)) return result;
  Eigen::VectorXd rest = problem.measured();
  for (Eigen::Index i = 0; i < count; ++i) rest -= result.weights[i] * of(i);
  result.squares = rest.squaredNorm();
  return result;
}

// The best of all choices of `terms` times from the grid.
WeightedTimes best_on_grid(const RateProblem& problem, const std::vector<double>& grid,
                           const std::vector<Eigen::VectorXd>& columns, int terms) {
  WeightedTimes best;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    if (terms == 1) {
      const WeightedTimes found = weigh(problem, {grid[i]}, {columns[i]});
      if (found.squares < best.squares) best = found;
    } else {
      for (std::size_t j = i + 1; j < grid.size(); ++j) {
        const WeightedTimes found = weigh(problem, {grid[i], grid[j]}, {columns[i], columns[j]});
        if (found.squares < best.squares) best = found;
      }
    }
  }
  return best;
}

// Refines each time in turn, within a step of the grid.
WeightedTimes refined(const RateProblem& problem, WeightedTimes best, double ratio) {
  if (!std::isfinite(best.squares)) return best;
  for (int round = 0; round < kRefinements; ++round, ratio = std::sqrt(ratio)) {
    const std::size_t turns = best.times.size();
    for (std::size_t i = 0; i < turns; ++i) {
      std::vector<Eigen::VectorXd> columns;
      for (const double time : best.times) columns.push_back(problem.column(time));
      const double middle = std::log(best.times[i]);
      const auto squares = [&](double logarithm) {
        std::vector<double> times = best.times;
        times[i] = std::exp(logarithm);
        columns[i] = problem.column(times[i]);
        const WeightedTimes found = weigh(problem, times, columns);
        if (found.squares < best.squares) best = found;
        return std::isfinite(found.squares) ? found.squares : 1e300;
      };
      std::uintmax_t evaluations = 12;
      boost::math::tools::brent_find_minima(squares, middle - std::log(ratio),
                                            middle + std::log(ratio), kTimeBits, evaluations);
    }
    if (turns == 1 && round >= 2) break;
  }
  return best;
}

// Standard errors of shares and times, from the derivatives of the forces by the logarithms of
// scale, shares and times.
std::vector<RateTerm> errors_of(const RateProblem& problem, const std::vector<RateTerm>& terms,
                                double scale, double squares, int samples) {
  const auto count = static_cast<Eigen::Index>(terms.size());
  const auto forces = [&](const Eigen::VectorXd& logs) {
    Eigen::VectorXd sum = problem.still();
    for (Eigen::Index i = 0; i < count; ++i) {
      const RateTerm& term = terms[static_cast<std::size_t>(i)];
      sum += term.share * std::exp(logs[1 + i]) *
             problem.column(term.time * std::exp(logs[1 + count + i]));
    }
    return Eigen::VectorXd(scale * std::exp(logs[0]) * sum);
  };
  const Eigen::Index unknowns = 1 + 2 * count;
  Eigen::MatrixXd jacobian(problem.measured().size(), unknowns);
  for (Eigen::Index i = 0; i < unknowns; ++i) {
    const Eigen::VectorXd step = kErrorStep * Eigen::VectorXd::Unit(unknowns, i);
    jacobian.col(i) = (forces(step) - forces(-step)) / (2 * kErrorStep);
  }
  const double variance = squares / std::max(1.0, static_cast<double>(samples - unknowns));
  const Eigen::MatrixXd covariance =
      variance * Eigen::MatrixXd(jacobian.transpose() * jacobian).inverse();
  std::vector<RateTerm> errors;
  for (Eigen::Index i = 0; i < count; ++i) {
    const RateTerm& term = terms[static_cast<std::size_t>(i)];
    errors.push_back({.share = term.share * std::sqrt(covariance(1 + i, 1 + i)),
                      .time = term.time * std::sqrt(covariance(1 + count + i, 1 + count + i))});
  }
  return errors;
}

struct TimeRange {
  double shortest, longest;  // [s] of terms
};

TimeRange check_records(std::span<const RateRecord> records) {
  std::vector<double> steps;
  double longest = 0;
  for (std::size_t r = 0; r < records.size(); ++r) {
    const RateRecord& record = records[r];
    const std::string name = "fit_rate(): record " + std::to_string(r);
    const auto count = static_cast<Eigen::Index>(record.path.time.size());
    if (record.path.displacements.cols() != count || record.forces.cols() != count ||
        record.path.begins.size() != record.path.time.size() ||
        (count > 0 && !record.path.begins[0])) {
      throw InvalidInput(name +
                         " must have as many times, displacements, forces and beginnings, "
                         "and begin at its first");
    }
    if (!record.path.displacements.allFinite() || !record.forces.allFinite())
      throw InvalidInput(name + " has numbers that are not finite; leave them out");
    double begun = 0;
    for (std::size_t k = 0; k < record.path.time.size(); ++k) {
      if (record.path.begins[k]) {
        begun = record.path.time[k];
        continue;
      }
      const double step = record.path.time[k] - record.path.time[k - 1];
      if (!(step > 0 && std::isfinite(step)))
        throw InvalidInput(name + ": times must ascend along a path");
      steps.push_back(step);
      longest = std::max(longest, record.path.time[k] - begun);
    }
  }
  if (steps.size() < 2) throw InvalidInput("fit_rate(): there is no path of three samples");
  return {median(steps), kLongestTime * longest};
}

}  // namespace

RateFit fit_rate(std::span<const RateRecord> records, const RateFitOptions& options) {
  require("RateFitOptions::most_terms", options.most_terms,
          at_least(0).at_most(static_cast<int>(DelayedDisplacements::kMost)));
  const TimeRange range = check_records(records);
  const RateProblem problem(records);
  RateFit fit;
  fit.samples = static_cast<int>(problem.measured().size() / 3);
  const WeightedTimes still = weigh(problem, {}, {});
  if (!std::isfinite(still.squares))
    throw InvalidInput("fit_rate(): the forces do not follow the fields at all");
  const double samples = fit.samples;
  fit.rms = fit.rms_without = std::sqrt(still.squares / samples);
  fit.scale = still.weights[0];

  std::vector<double> grid;
  std::vector<Eigen::VectorXd> columns;
  const double ratio = std::pow(range.longest / range.shortest, 1.0 / (kGrid - 1));
  for (int i = 0; i < kGrid; ++i) {
    grid.push_back(range.shortest * std::pow(ratio, i));
    columns.push_back(problem.column(grid.back()));
  }
  double squares = still.squares;
  for (int terms = 1; terms <= options.most_terms; ++terms) {
    const WeightedTimes found =
        refined(problem, best_on_grid(problem, grid, columns, terms), ratio);
    const double gain = samples / 2 * std::log(squares / found.squares);
    const bool better = gain > std::log(samples) &&
                        std::sqrt(found.squares) < (1 - kLeastTermGain) * std::sqrt(squares);
    if (!better) break;
    squares = found.squares;
    fit.scale = found.weights[0];
    fit.terms.clear();
    for (std::size_t i = 0; i < found.times.size(); ++i) {
      fit.terms.push_back({.share = found.weights[static_cast<Eigen::Index>(i) + 1] / fit.scale,
                           .time = found.times[i]});
    }
    std::ranges::sort(fit.terms, {}, &RateTerm::time);
    fit.rms = std::sqrt(squares / samples);
  }
  fit.errors = errors_of(problem, fit.terms, fit.scale, squares, fit.samples);
  return fit;
}

Eigen::Matrix3Xd rate_forces(std::span<const RateTerm> terms, const ForceField& field,
                             const ToolHistory& path) {
  Eigen::Matrix3Xd forces = Eigen::Matrix3Xd::Zero(3, path.displacements.cols());
  for (const RateTerm& term : terms) {
    const Eigen::Matrix3Xd ahead = displacement_ahead(path, term.time);
    for (Eigen::Index k = 0; k < ahead.cols(); ++k)
      forces.col(k) += term.share * force(field, ahead.col(k));
  }
  return forces;
}

}  // namespace palpate::haptics
