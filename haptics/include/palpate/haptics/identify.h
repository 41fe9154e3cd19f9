// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "palpate/core/fields.h"
#include "palpate/haptics/half_space_model.h"
#include "palpate/haptics/strip_model.h"
#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

/// `visit` describes the fields.
struct IdentifyOptions {
  /// If neither noise is given, both are estimated from the repeated positions `a` of each group.
  std::optional<double> displacement_noise = std::nullopt;
  std::optional<double> force_noise = std::nullopt;
  double max_chi2 = 2;  ///< 2 allows for a noise that is known to 40 %
  /// If the noise is estimated, chi^2 alone says little: groups that mix several normal forces
  /// scatter, and a model that explains nothing agrees with such a noise.
  double min_explained = 0.9;
};

void visit(IdentifyOptions& options, FieldVisitor& visitor);

enum class ParameterStatus {
  determined,   ///< has a value and a standard error
  at_bound,     ///< not determined: the search ended at its bound, which is `value`; no error
  undetermined  ///< the data do not determine it, or only in combination with others; no value
};

struct ParameterEstimate {
  std::string name;  ///< in words, such as "tension"
  std::string unit;  ///< "N", "mm", ..., empty for a ratio
  ParameterStatus status = ParameterStatus::undetermined;
  std::optional<double> value;
  /// Includes the factor sqrt(chi^2 per degree of freedom) if that is known: the observed scatter.
  std::optional<double> standard_error;
};

enum class Verdict {
  describes,          ///< chi^2 per degree of freedom <= max_chi2, explained >= min_explained
  does_not_describe,  ///< the object differs; the parameters are those of the nearest such model
  /// the noise is unknown, or is given and so large that a model which explains less than
  /// min_explained agrees with it, or there are no more data than parameters
  not_testable,
  not_converged  ///< the search did not converge; the parameters are meaningless
};

struct ContactAgreement {
  long long contact = 0;  ///< id
  double chi2 = 0;        ///< mean squared error in units of its standard deviation, per number
  int pairs = 0;
  int outliers = 0;  ///< pairs that are excluded from chi^2
};

/// Agreement of a parametric model with an acquisition.
struct Identification {
  std::vector<ParameterEstimate> parameters;
  /// Of the errors of two parameters, as many rows and columns as parameters; NaN where one is not
  /// determined.
  Eigen::MatrixXd correlations;
  std::vector<ContactAgreement> contacts;  ///< those with samples, in the acquisition's order
  std::optional<double> chi2;              ///< per degree of freedom; empty if not testable
  double rms = 0;                          ///< [mm] sqrt(mean |error|^2) of the displacements
  double explained = 0;  ///< share of the squared displacements; <= 1, < 0 if worse than no model
  double displacement_noise = 0;  ///< [mm] given or estimated
  double force_noise = 0;         ///< [N]
  int pairs = 0;
  int outliers = 0;
  int iterations = 0;
  Verdict verdict = Verdict::not_testable;
};

// Both functions use the realigned pairs (realignment.h) of displacement d and commanded force f of
// all contacts. They minimise the sum over pairs of rho(r^T S^-1 r), where rho is Huber's loss, r =
// d - d(f) is the residual, and S = s_d^2 I + s_f^2 C C^T is its covariance for the displacement
// noise s_d, the force noise s_f and the model's compliance C = dd/df. The mean of each group's
// positions `a` has an error that moves the whole group; it is subtracted from the other pairs.
//
// If a tool holds near the friction boundary, its force was inside by chance. The mean shift of the
// force due to this follows from the noise and the friction cone of each contact; the share of it
// that acts on the displacement is estimated with the parameters.
//
// The solver is Levenberg-Marquardt with bounds; S is updated until the parameters converge.
// Standard errors are those of the linearised problem. A parameter is not determined if changing it
// by its own size, alone or with others, changes the data by less than three deviations; the errors
// of the others then allow for a change by its size. The result does not depend on unit, frame or
// the order of samples.
//
// Both throw InvalidInput if an option is outside its range or there is no sample; SolverError if
// no parameters give every sample an equilibrium.

struct IdentifiedStrip {
  StripModel model;  ///< has an arbitrary value where a parameter is undetermined
  /// "tension", "axial stiffness", "low support", "high support", "lateral stiffness",
  /// "compliance", "slope", "curvature", "axis" (its angle [rad]; `model.axis` is its direction)
  Identification report;
};
[[nodiscard]] IdentifiedStrip identify_strip(const probing::CheckedAcquisition& acquisition,
                                             const IdentifyOptions& options = {});

struct IdentifiedHalfSpace {
  HalfSpaceModel model;
  Identification report;  ///< "Young's modulus", "Poisson's ratio"
};
/// \throws InvalidInput also unless tool_radius [mm] > 0.
[[nodiscard]] IdentifiedHalfSpace identify_half_space(
    const probing::CheckedAcquisition& acquisition, double tool_radius,
    const IdentifyOptions& options = {});

/// Names for reports.
[[nodiscard]] const char* to_string(ParameterStatus status);
[[nodiscard]] const char* to_string(Verdict verdict);

}  // namespace palpate::haptics
