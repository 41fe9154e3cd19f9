// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/field_solver.h"

#include <algorithm>

#include "fit/nonlinear_program.h"
#include "fit/stiffness_constraint.h"
#include "palpate/core/module.h"

namespace palpate::haptics {
namespace {

// Bounds of weights and centre coordinates, in units of the data's force and extent. A distant base
// acts as a constant force, and two of them cancel: they gain nothing and harm extrapolation.
constexpr double kMaxWeight = 30;
constexpr double kMaxCenter = 5;
// Bounds of free epsilons, in units of the data's extent. Beyond them epsilon hardly matters:
// below, a base is a kink at its centre; above, a parabola.
constexpr double kMinFreeEpsilon = 0.1;
constexpr double kMaxFreeEpsilon = 10;
constexpr double kSolverTolerance = 1e-5;  // of Ipopt, on quantities scaled to 1
constexpr int kMaxSolverIterations = 300;
constexpr double kUnbounded = 2e19;  // Ipopt's infinity

class FieldProgram : public NonlinearProgram {
 public:
  FieldProgram(const FieldObjective& objective, const Eigen::Ref<const Eigen::VectorXd>& start,
               const FieldConstraints& constraints)
      : objective_(objective),
        start_(start),
        constraints_(constraints),
        size_(start.size()),
        places_(static_cast<Eigen::Index>(constraints.places.size())),
        n_(size_ + stiffness_constraint::kSlacks),
        m_(stiffness_constraint::kCount + places_) {}

  [[nodiscard]] const FieldSolution& solution() const { return solution_; }

  [[nodiscard]] int variables() const override { return static_cast<int>(n_); }
  [[nodiscard]] int constraints() const override { return static_cast<int>(m_); }

  void bounds(double* least_x, double* most_x, double* least_g, double* most_g) const override {
    std::fill(most_x, most_x + n_, kUnbounded);
    std::fill(least_x, least_x + n_, -kUnbounded);
    for (Eigen::Index k = 0; k < size_; k += kBaseSize) {
      const double epsilon = start_[k + 4];
      most_x[k] = kMaxWeight;
      least_x[k] = -kMaxWeight;
      for (Eigen::Index i = k + 1; i < k + 4; ++i) {
        most_x[i] = kMaxCenter;
        least_x[i] = -kMaxCenter;
      }
      most_x[k + 4] = constraints_.free_epsilon ? kMaxFreeEpsilon : epsilon;
      least_x[k + 4] = constraints_.free_epsilon ? kMinFreeEpsilon : epsilon;
    }
    std::fill(least_g, least_g + m_, 0.0);
    std::fill(most_g, most_g + m_, kUnbounded);
    std::fill(most_g, most_g + stiffness_constraint::kCount, 0.0);
  }

  void start(double* x) const override {
    Eigen::Map<Eigen::VectorXd> values(x, n_);
    values.head(size_) = start_;
    values.tail(stiffness_constraint::kSlacks) =
        stiffness_constraint::start(stiffness(to_field(start_), Eigen::Vector3d::Zero()));
  }

  [[nodiscard]] double value(const double* x) const override {
    return objective_.value(parameters(x));
  }

  void gradient(const double* x, double* gradient) const override {
    Eigen::Map<Eigen::VectorXd> result(gradient, n_);
    result.head(size_) = objective_.gradient(parameters(x));
    result.tail(stiffness_constraint::kSlacks).setZero();
  }

  void constraint_values(const double* x, double* g) const override {
    Eigen::Map<Eigen::VectorXd> result(g, m_);
    result.head(stiffness_constraint::kCount) = stiffness_constraint::values(entries(x));
    for (Eigen::Index i = 0; i < places_; ++i) {
      const Eigen::Vector3d& place = constraints_.places[static_cast<std::size_t>(i)];
      result[m_ - places_ + i] =
          potential(to_field(parameters(x)), place) / scale(place) - constraints_.least_secant;
    }
  }

  void jacobian(const double* x, double* values) const override {
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> result(
        values, m_, n_);
    result.setZero();
    const Eigen::MatrixXd slopes = stiffness_constraint::jacobian(entries(x));
    result.topLeftCorner(stiffness_constraint::kCount, size_) =
        slopes.leftCols(kEntries) * entry_slopes(x).transpose();
    result.topRightCorner(stiffness_constraint::kCount, stiffness_constraint::kSlacks) =
        slopes.rightCols(stiffness_constraint::kSlacks);
    for (Eigen::Index i = 0; i < places_; ++i) {
      const Eigen::Vector3d& place = constraints_.places[static_cast<std::size_t>(i)];
      result.row(m_ - places_ + i).head(size_) =
          energy_at(parameters(x), place).gradient.transpose() / scale(place);
    }
  }

  void hessian(const double* x, double factor, const double* lambda,
               double* values) const override {
    const Eigen::Map<const Eigen::VectorXd> multipliers(lambda, m_);
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(n_, n_);
    hessian.topLeftCorner(size_, size_) = factor * objective_.hessian(parameters(x));
    add_stiffness(x, multipliers.head(stiffness_constraint::kCount), hessian);
    for (Eigen::Index i = 0; i < places_; ++i) {
      const Eigen::Vector3d& place = constraints_.places[static_cast<std::size_t>(i)];
      hessian.topLeftCorner(size_, size_) +=
          multipliers[m_ - places_ + i] / scale(place) * energy_at(parameters(x), place).hessian;
    }
    for (Eigen::Index row = 0, i = 0; row < n_; ++row) {
      for (Eigen::Index column = 0; column <= row; ++column, ++i) values[i] = hessian(row, column);
    }
  }

  void finish(const double* x, double value) override {
    solution_.parameters = parameters(x);
    solution_.value = value;
  }

 private:
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> parameters(const double* x) const {
    return {x, size_};
  }

  static double scale(const Eigen::Vector3d& place) { return place.squaredNorm() / 2; }

  // Arguments of the stiffness constraint: entries of K - least_stiffness I, then the slacks.
  [[nodiscard]] Eigen::VectorXd entries(const double* x) const {
    const Eigen::Matrix3d excess = stiffness(to_field(parameters(x)), Eigen::Vector3d::Zero()) -
                                   constraints_.least_stiffness * Eigen::Matrix3d::Identity();
    Eigen::VectorXd result(kEntries + static_cast<std::size_t>(n_ - size_));
    for (std::size_t e = 0; e < kEntries; ++e) {
      result[static_cast<Eigen::Index>(e)] = excess(kEntryRow[e], kEntryColumn[e]);
    }
    result.tail(n_ - size_) = Eigen::Map<const Eigen::VectorXd>(x + size_, n_ - size_);
    return result;
  }

  // Derivatives of the entries of K, one column per entry.
  [[nodiscard]] Eigen::MatrixXd entry_slopes(const double* x) const {
    Eigen::MatrixXd result(size_, kEntries);
    for (std::size_t e = 0; e < kEntries; ++e) {
      Eigen::VectorXd one = Eigen::VectorXd::Zero(kEntries);
      one[static_cast<Eigen::Index>(e)] = 1;
      result.col(static_cast<Eigen::Index>(e)) =
          stiffness_at_zero(parameters(x), contraction(one)).gradient;
    }
    return result;
  }

  // The symmetric matrix L for which L . K is the sum of K's entries times these factors.
  static Eigen::Matrix3d contraction(const Eigen::Ref<const Eigen::VectorXd>& factors) {
    Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
    for (std::size_t e = 0; e < kEntries; ++e) {
      const double half = factors[static_cast<Eigen::Index>(e)] / 2;
      result(kEntryRow[e], kEntryColumn[e]) += half;
      result(kEntryColumn[e], kEntryRow[e]) += half;
    }
    return result;
  }

  // Second-order chain rule through the entries of K.
  void add_stiffness(const double* x, const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                     Eigen::MatrixXd& hessian) const {
    const Eigen::VectorXd y = entries(x);
    const Eigen::VectorXd factors =
        stiffness_constraint::jacobian(y).leftCols(kEntries).transpose() * multipliers;
    const Eigen::MatrixXd curvature = stiffness_constraint::hessian(multipliers);
    const Eigen::MatrixXd slopes = entry_slopes(x);
    hessian.topLeftCorner(size_, size_) +=
        stiffness_at_zero(parameters(x), contraction(factors)).hessian +
        slopes * curvature.topLeftCorner(kEntries, kEntries) * slopes.transpose();
    hessian.bottomRightCorner(n_ - size_, n_ - size_) +=
        curvature.bottomRightCorner(n_ - size_, n_ - size_);
  }

  const FieldObjective& objective_;
  Eigen::VectorXd start_;
  const FieldConstraints& constraints_;
  Eigen::Index size_, places_, n_, m_;
  FieldSolution solution_;
};

const ProgramSolver& program_solver() {
  static const void* const solver = module_symbol("ipopt");
  return *static_cast<const ProgramSolver*>(solver);
}

}  // namespace

FieldSolution solve_field(const FieldObjective& objective,
                          const Eigen::Ref<const Eigen::VectorXd>& start,
                          const FieldConstraints& constraints) {
  FieldProgram program(objective, start, constraints);
  const ProgramEnd end = program_solver().solve(program, kSolverTolerance, kMaxSolverIterations);
  FieldSolution solution = program.solution();
  if (solution.parameters.size() == 0) {  // Ipopt gave up before the first iteration
    solution.parameters = start;
    solution.value = objective.value(start);
  }
  solution.converged = end.converged;
  solution.iterations = end.iterations;
  return solution;
}

}  // namespace palpate::haptics
