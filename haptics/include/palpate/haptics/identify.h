// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "palpate/haptics/half_space_model.h"
#include "palpate/haptics/strip_model.h"
#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

struct IdentifyOptions {
  /// [mm] > 0, deviation of each component of a position; without it and without `force_noise` both
  /// are estimated from the repeated positions `a` of each group
  std::optional<double> displacement_noise = std::nullopt;
  std::optional<double> force_noise = std::nullopt;  ///< [N] >= 0, of each component; goes with it
  /// The parametric model describes the object iff chi^2 per degree of freedom <= this; > 1. 2
  /// leaves room for a noise that is known to 40 %.
  double max_chi2 = 2;
  int max_iterations = 100;  ///< >= 1, of each Levenberg-Marquardt search
};

enum class ParameterStatus {
  determined,   ///< value and standard error
  at_bound,     ///< not determined either: the search ended at its bound, `value`; no error
  undetermined  ///< the data do not determine it, or only together with others: no number
};

struct ParameterEstimate {
  std::string name;  ///< in words: "tension", ...
  std::string unit;  ///< "N", "mm", ..., empty for a ratio
  ParameterStatus status = ParameterStatus::undetermined;
  std::optional<double> value;
  /// Times sqrt(chi^2 per degree of freedom) where that is known: what the scatter shows.
  std::optional<double> standard_error;
};

enum class Verdict {
  describes,          ///< chi^2 per degree of freedom <= max_chi2
  does_not_describe,  ///< the object is another: parameters are those of the nearest such model
  not_testable,       ///< the noise is not known, or there are no more data than parameters
  not_converged       ///< the search did not settle: no parameter means anything
};

struct ContactAgreement {
  long long contact = 0;  ///< id
  double chi2 = 0;        ///< per number: mean squared error in units of its deviation
  int pairs = 0;
  int outliers = 0;  ///< single pairs that are left out of chi^2
};

/// How well a parametric model agrees with an acquisition.
struct Identification {
  std::vector<ParameterEstimate> parameters;
  std::vector<ContactAgreement> contacts;  ///< those with samples, in the acquisition's order
  std::optional<double> chi2;              ///< per degree of freedom; nothing if not testable
  double rms = 0;                          ///< [mm] sqrt(mean |error|^2) of the displacements
  double displacement_noise = 0;           ///< [mm] as given or estimated
  double force_noise = 0;                  ///< [N]
  int pairs = 0;
  int outliers = 0;
  int iterations = 0;
  Verdict verdict = Verdict::not_testable;
};

// Both take the realigned pairs of all contacts (realignment.h), displacements d and commanded
// forces f, and minimise the sum over pairs of rho(r^T S^-1 r): r = d - d(f), what the model
// misses; S = s_d^2 I + s_f^2 C C^T its covariance for displacement noise s_d, force noise s_f and
// the model's compliance C = dd/df; rho Huber's loss. The mean of each group's positions `a` has an
// error of its own that moves the whole group: it is taken off the other pairs. Levenberg and
// Marquardt's method with bounds; S is renewed until the parameters rest. Standard errors are those
// of the linearised problem; parameters are not determined if changing them by as much as their own
// size, alone or together, shows by less than three deviations. Neither unit, frame nor the order
// of samples matters. They throw InvalidInput on options out
// of range or no sample at all; SolverError if no parameters give every sample an equilibrium.

struct IdentifiedStrip {
  StripModel model;  ///< with some value where a parameter is undetermined
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

/// In words, for reports.
[[nodiscard]] const char* to_string(ParameterStatus status);
[[nodiscard]] const char* to_string(Verdict verdict);

}  // namespace palpate::haptics
