// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "field_solver.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <coin/IpIpoptApplication.hpp>
#include <coin/IpSolveStatistics.hpp>
#include <coin/IpTNLP.hpp>
#include <mutex>

namespace palpate::haptics {
namespace {

using Ipopt::Index;
using Ipopt::Number;

// Bounds of weights and of centre coordinates, in units of the data's force and extent. Far out, a
// base is a constant force and two of them cancel: nothing is gained there, and extrapolation
// suffers.
constexpr double kMaxWeight = 30;
constexpr double kMaxCenter = 5;
// The stiffness at zero is kept >= kStiffnessMargin, in units of force / extent: above what the
// solver leaves of a constraint, so that the result is semi-definite in floating point too.
constexpr double kStiffnessMargin = 1e-5;
constexpr double kTolerance = 1e-5;  // of Ipopt, on quantities scaled to 1
constexpr int kMaxIterations = 300;

// K = margin I + C C^T with C lower triangular says that K is positive definite, by equalities that
// are smooth everywhere. The six entries of C follow the parameters of the field.
constexpr Index kFactorSize = 6;
constexpr std::array<int, kFactorSize> kRow = {0, 1, 1, 2, 2, 2};
constexpr std::array<int, kFactorSize> kColumn = {0, 0, 1, 0, 1, 2};

Eigen::Matrix3d to_factor(const Number* entries) {
  Eigen::Matrix3d factor = Eigen::Matrix3d::Zero();
  for (std::size_t e = 0; e < kFactorSize; ++e) factor(kRow[e], kColumn[e]) = entries[e];
  return factor;
}

// Picks entry (row, column) of a symmetric matrix when contracted with it.
Eigen::Matrix3d picker(std::size_t e) {
  Eigen::Matrix3d result = Eigen::Matrix3d::Zero();
  result(kRow[e], kColumn[e]) += 0.5;
  result(kColumn[e], kRow[e]) += 0.5;
  return result;
}

class FieldProgram : public Ipopt::TNLP {
 public:
  FieldProgram(const FieldObjective& objective, const Eigen::Ref<const Eigen::VectorXd>& start)
      : objective_(objective), start_(start), size_(static_cast<Index>(start.size())) {}

  [[nodiscard]] const FieldSolution& solution() const { return solution_; }

  bool get_nlp_info(Index& n, Index& m, Index& nnz_jac_g, Index& nnz_h_lag,
                    IndexStyleEnum& index_style) override {
    n = size_ + kFactorSize;
    m = kFactorSize;
    nnz_jac_g = m * n;
    nnz_h_lag = n * (n + 1) / 2;
    index_style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index n, Number* x_l, Number* x_u, Index m, Number* g_l,
                       Number* g_u) override {
    constexpr double kUnbounded = 2e19;  // Ipopt's infinity
    for (Index i = 0; i < n; ++i) {
      x_u[i] = i >= size_ ? kUnbounded : i % 4 == 0 ? kMaxWeight : kMaxCenter;
      x_l[i] = -x_u[i];
    }
    std::fill(g_l, g_l + m, 0.0);
    std::fill(g_u, g_u + m, 0.0);
    return true;
  }

  bool get_starting_point(Index n, bool, Number* x, bool, Number*, Number*, Index, bool,
                          Number*) override {
    Eigen::Map<Eigen::VectorXd> values(x, n);
    values.head(size_) = start_;
    // The Cholesky factor of the nearest positive definite matrix.
    const Eigen::Matrix3d stiffness_zero =
        stiffness(to_field(start_, objective_.epsilon), Eigen::Vector3d::Zero());
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(stiffness_zero);
    const double floor = 1e-2;  // of force / extent: away from the kink of the factor at zero
    const Eigen::Vector3d values_kept = eigen.eigenvalues().cwiseMax(floor);
    const Eigen::Matrix3d near =
        eigen.eigenvectors() * values_kept.asDiagonal() * eigen.eigenvectors().transpose();
    const Eigen::Matrix3d factor = near.llt().matrixL();
    for (std::size_t e = 0; e < kFactorSize; ++e) {
      values[size_ + static_cast<Index>(e)] = factor(kRow[e], kColumn[e]);
    }
    return true;
  }

  bool eval_f(Index, const Number* x, bool, Number& value) override {
    value = objective_.value(parameters(x));
    return true;
  }

  bool eval_grad_f(Index n, const Number* x, bool, Number* gradient) override {
    Eigen::Map<Eigen::VectorXd> result(gradient, n);
    result.head(size_) = objective_.gradient(parameters(x));
    result.tail<kFactorSize>().setZero();
    return true;
  }

  bool eval_g(Index, const Number* x, bool, Index, Number* g) override {
    const Eigen::Matrix3d factor = to_factor(x + size_);
    const Eigen::Matrix3d excess =
        stiffness(to_field(parameters(x), objective_.epsilon), Eigen::Vector3d::Zero()) -
        factor * factor.transpose() - kStiffnessMargin * Eigen::Matrix3d::Identity();
    for (std::size_t e = 0; e < kFactorSize; ++e) g[e] = excess(kRow[e], kColumn[e]);
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
    const Eigen::Matrix3d factor = to_factor(x + size_);
    for (std::size_t e = 0; e < kFactorSize; ++e) {
      Eigen::Map<Eigen::VectorXd> row(values + static_cast<Index>(e) * n, n);
      row.head(size_) = objective_.stiffness_at_zero(parameters(x), picker(e)).gradient;
      // d(C C^T)/dC_ab, entry e: (E C^T + C E^T) with E the unit matrix of (a, b)
      for (std::size_t v = 0; v < kFactorSize; ++v) {
        double slope = 0;
        if (kRow[v] == kRow[e]) slope += factor(kColumn[e], kColumn[v]);
        if (kRow[v] == kColumn[e]) slope += factor(kRow[e], kColumn[v]);
        row[size_ + static_cast<Index>(v)] = -slope;
      }
    }
    return true;
  }

  bool eval_h(Index n, const Number* x, bool, Number objective_factor, Index, const Number* lambda,
              bool, Index, Index* rows, Index* columns, Number* values) override {
    if (!values) {
      for (Index row = 0, i = 0; row < n; ++row) {
        for (Index column = 0; column <= row; ++column, ++i) {
          rows[i] = row;
          columns[i] = column;
        }
      }
      return true;
    }
    Eigen::Matrix3d multiplier = Eigen::Matrix3d::Zero();
    for (std::size_t e = 0; e < kFactorSize; ++e) multiplier += lambda[e] * picker(e);
    Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(n, n);
    hessian.topLeftCorner(size_, size_) =
        objective_factor * objective_.hessian(parameters(x)) +
        objective_.stiffness_at_zero(parameters(x), multiplier).hessian;
    // multiplier . (C C^T) is a quadratic form in the columns of C.
    for (std::size_t v = 0; v < kFactorSize; ++v) {
      for (std::size_t w = 0; w < kFactorSize; ++w) {
        if (kColumn[v] != kColumn[w]) continue;
        hessian(size_ + static_cast<Index>(v), size_ + static_cast<Index>(w)) =
            -2 * multiplier(kRow[v], kRow[w]);
      }
    }
    for (Index row = 0, i = 0; row < n; ++row) {
      for (Index column = 0; column <= row; ++column, ++i) values[i] = hessian(row, column);
    }
    return true;
  }

  void finalize_solution(Ipopt::SolverReturn status, Index, const Number* x, const Number*,
                         const Number*, Index, const Number*, const Number*, Number value,
                         const Ipopt::IpoptData*, Ipopt::IpoptCalculatedQuantities*) override {
    solution_.parameters = parameters(x);
    solution_.value = value;
    solution_.converged = status == Ipopt::SUCCESS || status == Ipopt::STOP_AT_ACCEPTABLE_POINT;
  }

 private:
  [[nodiscard]] Eigen::Map<const Eigen::VectorXd> parameters(const Number* x) const {
    return {x, size_};
  }

  const FieldObjective& objective_;
  Eigen::VectorXd start_;
  Index size_;
  FieldSolution solution_;
};

}  // namespace

FieldSolution solve_field(const FieldObjective& objective,
                          const Eigen::Ref<const Eigen::VectorXd>& start) {
  // MUMPS, Ipopt's linear solver, keeps global state: one solve at a time.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  Ipopt::SmartPtr<FieldProgram> program = new FieldProgram(objective, start);
  Ipopt::SmartPtr<Ipopt::IpoptApplication> application = new Ipopt::IpoptApplication(false);
  const auto options = application->Options();
  options->SetStringValue("sb", "yes");
  options->SetIntegerValue("print_level", 0);
  options->SetStringValue("nlp_scaling_method", "none");
  options->SetNumericValue("tol", kTolerance);
  options->SetIntegerValue("max_iter", kMaxIterations);
  application->Initialize(
      "");  // not from an ipopt.opt that happens to lie in the working directory
  application->OptimizeTNLP(program);
  FieldSolution solution = program->solution();
  if (Ipopt::IsValid(application->Statistics())) {
    solution.iterations = application->Statistics()->IterationCount();
  }
  return solution;
}

}  // namespace palpate::haptics
