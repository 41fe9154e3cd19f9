// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/core/fields.h"
#include "palpate/probing/probing_program.h"

namespace palpate::probing {

/// The strategy by which trials are chosen.
enum class TrialStrategy {
  pooled,     ///< the most informative ones for friction, given those of other contacts
  bisection,  ///< thesis 4.3
  adaptive    ///< those that reduce the error of the model most per second: `AdaptiveTrials`
};
/// "pooled", "bisection", "adaptive".
[[nodiscard]] const char* to_string(TrialStrategy strategy);

/// `visit` describes the fields.
struct CampaignOptions {
  TrialStrategy strategy = TrialStrategy::pooled;
  unsigned seed = 1;
  double resolution = 0.1;
  double cautious = 0.3;
  double friction_accuracy = 0.01;
  int most_failures = 4;
  int reference_every = 50;
  ProgramOptions program = {};
  /// `adaptive` needs one of these limits, and the others have none; 0: no limit
  double until = 0;
  double max_hours = 0;
  int max_samples = 0;
};

void visit(CampaignOptions& options, FieldVisitor& visitor);

/// \throws InvalidInput if an option is outside its range, or a limit is missing or of another
/// strategy.
void check_campaign_options(const CampaignOptions& options);

}  // namespace palpate::probing
