// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::haptics {

/// A program of n variables x and m constraints g(x): the least f(x) with bounds of x and g.
class NonlinearProgram {
 public:
  virtual ~NonlinearProgram() = default;

  [[nodiscard]] virtual int variables() const = 0;
  [[nodiscard]] virtual int constraints() const = 0;
  /// Bounds of 2e19 and more count as none.
  virtual void bounds(double* least_x, double* most_x, double* least_g, double* most_g) const = 0;
  virtual void start(double* x) const = 0;
  [[nodiscard]] virtual double value(const double* x) const = 0;
  virtual void gradient(const double* x, double* result) const = 0;
  virtual void constraint_values(const double* x, double* result) const = 0;
  /// Of g, row by row.
  virtual void jacobian(const double* x, double* result) const = 0;
  /// Second derivatives of factor f(x) + multipliers . g(x): the lower half, row by row.
  virtual void hessian(const double* x, double factor, const double* multipliers,
                       double* result) const = 0;
  /// Takes the last x and f(x).
  virtual void finish(const double* x, double value) = 0;
};

/// How a solver ended.
struct ProgramEnd {
  int iterations = 0;
  bool converged = false;
};

/// Functions of the module `ipopt`: Ipopt, which needs MUMPS, LAPACK and the library of Fortran.
struct ProgramSolver {
  /// Calls `finish` unless Ipopt gives up before the first iteration.
  /// \param tolerance on quantities scaled to 1.
  /// \throws SolverError if Ipopt cannot be set up.
  ProgramEnd (*solve)(NonlinearProgram& program, double tolerance, int max_iterations);
};

}  // namespace palpate::haptics

extern "C" const palpate::haptics::ProgramSolver palpate_ipopt;
