// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fit/field_solver.h"

#include <algorithm>
#include <coin/IpIpoptApplication.hpp>
#include <coin/IpSolveStatistics.hpp>
#include <coin/IpTNLP.hpp>
#include <mutex>

#include "fit/stiffness_constraint.h"
#include "palpate/core/error.h"

namespace palpate::haptics {
namespace {

using Ipopt::Index;
using Ipopt::Number;

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

class FieldProgram : public Ipopt::TNLP {
 public:
  FieldProgram(const FieldObjective& objective, const Eigen::Ref<const Eigen::VectorXd>& start,
               const FieldConstraints& constraints)
      : objective_(objective),
        start_(start),
        constraints_(constraints),
        size_(static_cast<Index>(start.size())),
        places_(static_cast<Index>(constraints.places.size())) {}

  [[nodiscard]] const FieldSolution& solution() const { return solution_; }

  bool get_nlp_info(Index& n, Index& m, Index& nnz_jac_g, Index& nnz_h_lag,
                    IndexStyleEnum& index_style) override {
    n = size_ + static_cast<Index>(stiffness_constraint::kSlacks);
    m = static_cast<Index>(stiffness_constraint::kCount) + places_;
    nnz_jac_g = m * n;
    nnz_h_lag = n * (n + 1) / 2;
    index_style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* x_l, Number* x_u, Index m, Number* g_l,
                       Number* g_u) override {
    std::fill(x_u, x_u + n, kUnbounded);
    std::fill(x_l, x_l + n, -kUnbounded);
    for (Index k = 0; k < size_; k += kBaseSize) {
      const double epsilon = start_[k + 4];
      x_u[k] = kMaxWeight;
      x_l[k] = -kMaxWeight;
      for (Index i = k + 1; i < k + 4; ++i) {
        x_u[i] = kMaxCenter;
        x_l[i] = -kMaxCenter;
      }
      x_u[k + 4] = constraints_.free_epsilon ? kMaxFreeEpsilon : epsilon;
      x_l[k + 4] = constraints_.free_epsilon ? kMinFreeEpsilon : epsilon;
    }
    std::fill(g_l, g_l + m, 0.0);
    std::fill(g_u, g_u + m, kUnbounded);
    std::fill(g_u, g_u + stiffness_constraint::kCount, 0.0);
    return true;
  }

  bool get_starting_point(Index n, bool, Number* x, bool, Number*, Number*, Index, bool,
                          Number*) override {
    Eigen::Map<Eigen::VectorXd> values(x, n);
    values.head(size_) = start_;
    values.tail(stiffness_constraint::kSlacks) =
        stiffness_constraint::start(stiffness(to_field(start_), Eigen::Vector3d::Zero()));
    return true;
  }

  bool eval_f(Index, const Number* x, bool, Number& value) override {
    value = objective_.value(parameters(x));
    return true;
  }

  bool eval_grad_f(Index n, const Number* x, bool, Number* gradient) override {
    Eigen::Map<Eigen::VectorXd> result(gradient, n);
    result.head(size_) = objective_.gradient(parameters(x));
    result.tail(stiffness_constraint::kSlacks).setZero();
    return true;
  }

  bool eval_g(Index n, const Number* x, bool, Index m, Number* g) override {
    Eigen::Map<Eigen::VectorXd> result(g, m);
    result.head(stiffness_constraint::kCount) = stiffness_constraint::values(entries(n, x));
    for (Index i = 0; i < places_; ++i) {
      const Eigen::Vector3d& place = constraints_.places[static_cast<std::size_t>(i)];
      result[m - places_ + i] =
          potential(to_field(parameters(x)), place) / scale(place) - constraints_.least_secant;
    }
    return true;
  }

  bool eval_jac_g(Index n, const Number* x, bool, Index m, Index, Index* rows, Index* columns,
                  Number* values) override {
    if (!values) {
      for (Index i = 0; i < m * n; ++i) {
        rows[i] = i / n;
        columns[i] = i % n;
      }
      return true;
    }
    Eigen::Map<Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>> result(
        values, m, n);
    result.setZero();
    const Eigen::MatrixXd slopes = stiffness_constraint::jacobian(entries(n, x));
    result.topLeftCorner(stiffness_constraint::kCount, size_) =
        slopes.leftCols(kEntries) * entry_slopes(x).transpose();
    result.topRightCorner(stiffness_constraint::kCount, stiffness_constraint::kSlacks) =
        slopes.rightCols(stiffness_constraint::kSlacks);
    for (Index i = 0; i < places_; ++i) {
      const Eigen::Vector3d& place = constraints_.places[static_cast<std::size_t>(i)];
      result.row(m - places_ + i).head(size_) =
          energy_at(parameters(x), place).gradient.transpose() / scale(place);
    }
    return true;
  }

  bool eval_h(Index n, const Number* x, bool, Number objective_factor, Index m,
              const Number* lambda, bool, Index, Index* rows, Index* columns,
              Number* values) override {
    if (!values) {
      for (Index row = 0, i = 0; row < n; ++row) {
        for (Index column = 0; column <= row; ++column, ++i) {
          rows[i] = row;
          columns[i] = column;
        }
      }
      return true;
    }
    const Eigen::Map<const Eigen::VectorXd> multipliers(lambda, m);
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(n, n);
    hessian.topLeftCorner(size_, size_) = objective_factor * objective_.hessian(parameters(x));
    add_stiffness(n, x, multipliers.head(stiffness_constraint::kCount), hessian);
    for (Index i = 0; i < places_; ++i) {
      const Eigen::Vector3d& place = constraints_.places[static_cast<std::size_t>(i)];
      hessian.topLeftCorner(size_, size_) +=
          multipliers[m - places_ + i] / scale(place) * energy_at(parameters(x), place).hessian;
    }
    for (Index row = 0, i = 0; row < n; ++row) {
      for (Index column = 0; column <= row; ++column, ++i) values[i] = hessian(row, column);
    }
    return true;
  }

  void finalize_solution(Ipopt::SolverReturn, Index, const Number* x, const Number*, const Number*,
                         Index, const Number*, const Number*, Number value, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    solution_.parameters = parameters(x);
    solution_.value = value;
  }

 private:
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> parameters(const Number* x) const {
    return {x, size_};
  }

  static double scale(const Eigen::Vector3d& place) { return place.squaredNorm() / 2; }

  // Arguments of the stiffness constraint: entries of K - least_stiffness I, then the slacks.
  [[nodiscard]] Eigen::VectorXd entries(Index n, const Number* x) const {
    const Eigen::Matrix3d excess = stiffness(to_field(parameters(x)), Eigen::Vector3d::Zero()) -
                                   constraints_.least_stiffness * Eigen::Matrix3d::Identity();
    Eigen::VectorXd result(kEntries + static_cast<std::size_t>(n - size_));
    for (std::size_t e = 0; e < kEntries; ++e) {
      result[static_cast<Eigen::Index>(e)] = excess(kEntryRow[e], kEntryColumn[e]);
    }
    result.tail(n - size_) = Eigen::Map<const Eigen::VectorXd>(x + size_, n - size_);
    return result;
  }

  // Derivatives of the entries of K, one column per entry.
  [[nodiscard]] Eigen::MatrixXd entry_slopes(const Number* x) const {
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
  void add_stiffness(Index n, const Number* x, const Eigen::Ref<const Eigen::VectorXd>& multipliers,
                     Eigen::MatrixXd& hessian) const {
    const Eigen::VectorXd y = entries(n, x);
    const Eigen::VectorXd factors =
        stiffness_constraint::jacobian(y).leftCols(kEntries).transpose() * multipliers;
    const Eigen::MatrixXd curvature = stiffness_constraint::hessian(multipliers);
    const Eigen::MatrixXd slopes = entry_slopes(x);
    hessian.topLeftCorner(size_, size_) +=
        stiffness_at_zero(parameters(x), contraction(factors)).hessian +
        slopes * curvature.topLeftCorner(kEntries, kEntries) * slopes.transpose();
    hessian.bottomRightCorner(n - size_, n - size_) +=
        curvature.bottomRightCorner(n - size_, n - size_);
  }

  const FieldObjective& objective_;
  Eigen::VectorXd start_;
  const FieldConstraints& constraints_;
  Index size_, places_;
  FieldSolution solution_;
};

}  // namespace

FieldSolution solve_field(const FieldObjective& objective,
                          const Eigen::Ref<const Eigen::VectorXd>& start,
                          const FieldConstraints& constraints) {
  // Debian's Ipopt has only the linear solver MUMPS, which keeps global state, and its headers
  // allow no other solver. So only one solve runs at a time.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  Ipopt::SmartPtr<FieldProgram> program = new FieldProgram(objective, start, constraints);
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application = new Ipopt::IpoptApplication(false);
  const auto options = application->Options();
  options->SetStringValue("sb", "yes");
  options->SetIntegerValue("print_level", 0);
  options->SetStringValue("nlp_scaling_method", "none");
  options->SetNumericValue("tol", kSolverTolerance);
  options->SetIntegerValue("max_iter", kMaxSolverIterations);
  // An empty name prevents Ipopt from reading an ipopt.opt in the working directory.
  if (application->Initialize("") != Ipopt::Solve_Succeeded) {
    throw SolverError("solve_field(): Ipopt could not be set up; is its linear solver installed?");
  }
  const Ipopt::ApplicationReturnStatus status = application->OptimizeTNLP(program);
  FieldSolution solution = program->solution();
  if (solution.parameters.size() == 0) {  // Ipopt gave up before the first iteration
    solution.parameters = start;
    solution.value = objective.value(start);
  }
  solution.converged =
      status == Ipopt::Solve_Succeeded || status == Ipopt::Solved_To_Acceptable_Level;
  if (Ipopt::IsValid(application->Statistics())) {
    solution.iterations = application->Statistics()->IterationCount();
  }
  return solution;
}

}  // namespace palpate::haptics
