// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
// The whole of the module `ipopt`.
#include <coin/IpIpoptApplication.hpp>
#include <coin/IpSolveStatistics.hpp>
#include <coin/IpTNLP.hpp>
#include <mutex>

#include "fit/nonlinear_program.h"
#include "palpate/core/error.h"

namespace palpate::haptics {
namespace {

using Ipopt::Index;
using Ipopt::Number;

class IpoptProgram : public Ipopt::TNLP {
 public:
  explicit IpoptProgram(NonlinearProgram& program) : program_(program) {}

  bool get_nlp_info(Index& n, Index& m, Index& nnz_jac_g, Index& nnz_h_lag,
                    IndexStyleEnum& index_style) override {
    n = program_.variables();
    m = program_.constraints();
    nnz_jac_g = m * n;
    nnz_h_lag = n * (n + 1) / 2;
    index_style = C_STYLE;
    return true;
  }

  bool get_bounds_info(Index, Number* x_l, Number* x_u, Index, Number* g_l, Number* g_u) override {
    program_.bounds(x_l, x_u, g_l, g_u);
    return true;
  }

  bool get_starting_point(Index, bool, Number* x, bool, Number*, Number*, Index, bool,
                          Number*) override {
    program_.start(x);
    return true;
  }

  bool eval_f(Index, const Number* x, bool, Number& value) override {
    value = program_.value(x);
    return true;
  }

  bool eval_grad_f(Index, const Number* x, bool, Number* gradient) override {
    program_.gradient(x, gradient);
    return true;
  }

  bool eval_g(Index, const Number* x, bool, Index, Number* g) override {
    program_.constraint_values(x, g);
    return true;
  }

  bool eval_jac_g(Index n, const Number* x, bool, Index m, Index, Index* rows, Index* columns,
                  Number* values) override {
    if (values) {
      program_.jacobian(x, values);
      return true;
    }
    for (Index i = 0; i < m * n; ++i) {
      rows[i] = i / n;
      columns[i] = i % n;
    }
    return true;
  }

  bool eval_h(Index n, const Number* x, bool, Number objective_factor, Index, const Number* lambda,
              bool, Index, Index* rows, Index* columns, Number* values) override {
    if (values) {
      program_.hessian(x, objective_factor, lambda, values);
      return true;
    }
    for (Index row = 0, i = 0; row < n; ++row) {
      for (Index column = 0; column <= row; ++column, ++i) {
        rows[i] = row;
        columns[i] = column;
      }
    }
    return true;
  }

  void finalize_solution(Ipopt::SolverReturn, Index, const Number* x, const Number*, const Number*,
                         Index, const Number*, const Number*, Number value, const Ipopt::IpoptData*,
                         Ipopt::IpoptCalculatedQuantities*) override {
    program_.finish(x, value);
  }

 private:
  NonlinearProgram& program_;
};

ProgramEnd solve(NonlinearProgram& program, double tolerance, int max_iterations) {
  // Debian's Ipopt has only the linear solver MUMPS, which keeps global state, and its headers
  // allow no other solver. So only one solve runs at a time.
  static std::mutex one_at_a_time;
  const std::lock_guard lock(one_at_a_time);
  const Ipopt::SmartPtr<IpoptProgram> adapter = new IpoptProgram(program);
  const Ipopt::SmartPtr<Ipopt::IpoptApplication> application = new Ipopt::IpoptApplication(false);
  const auto options = application->Options();
  options->SetStringValue("sb", "yes");
  options->SetIntegerValue("print_level", 0);
  options->SetStringValue("nlp_scaling_method", "none");
  options->SetNumericValue("tol", tolerance);
  options->SetIntegerValue("max_iter", max_iterations);
  // An empty name prevents Ipopt from reading an ipopt.opt in the working directory.
  if (application->Initialize("") != Ipopt::Solve_Succeeded) {
    throw SolverError("solve_field(): Ipopt could not be set up; is its linear solver installed?");
  }
  const Ipopt::ApplicationReturnStatus status = application->OptimizeTNLP(adapter);
  ProgramEnd end;
  end.converged = status == Ipopt::Solve_Succeeded || status == Ipopt::Solved_To_Acceptable_Level;
  if (Ipopt::IsValid(application->Statistics()))
    end.iterations = application->Statistics()->IterationCount();
  return end;
}

}  // namespace
}  // namespace palpate::haptics

const palpate::haptics::ProgramSolver palpate_ipopt{&palpate::haptics::solve};
