// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <span>

#include "palpate/probing/contact_plan.h"
#include "palpate/probing/probing_program.h"

namespace palpate::probing {

/// A press that a campaign repeats, always the same, to see whether the object or the arm changes.
/// It is no sample, and no decision depends on it.
struct ReferenceProbe {
  long long number = 0;  ///< 0, 1, ...
  long long trials = 0;  ///< of the campaign before it
  double time = 0;       ///< [s] since the campaign began
  TrialResult result = {};
};

/// Reference probes count their trials from this number on, so that the errors of a simulated arm
/// in the other trials are the same with and without them.
inline constexpr long long kFirstReferenceTrial = 1'000'000'000;

/// The press: the normal force of the middle level, at the first contact of the plan.
/// \throws InvalidInput if the plan has no contact or no level.
[[nodiscard]] TrialOrder reference_order(const ContactPlan& plan, long long number);

/// Change of the displacement under the reference force.
struct ReferenceDrift {
  int probes = 0;  ///< that came to rest
  /// [mm] mean, from the planned place of the contact into the object; NaN without a probe
  double displacement = std::numeric_limits<double>::quiet_NaN();
  /// [mm] from the first probe to the last, by a line of least squares over time; NaN if there are
  /// fewer than three
  double change = std::numeric_limits<double>::quiet_NaN();
  double error = std::numeric_limits<double>::quiet_NaN();  ///< [mm] its standard deviation
};

/// \param options with the noise of positions and forces, from which the error follows.
[[nodiscard]] ReferenceDrift reference_drift(std::span<const ReferenceProbe> probes,
                                             const ContactPlan& plan,
                                             const ProgramOptions& options = {});

}  // namespace palpate::probing
