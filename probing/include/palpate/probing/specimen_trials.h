// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <vector>

#include "palpate/probing/acquisition.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/specimen.h"
#include "palpate/probing/specimen_response.h"

namespace palpate::probing {

struct SpecimenTrialOptions {
  /// Called after each equilibrium with the number of equilibria done and in all, from one thread
  /// at a time. An exception that it throws ends the work.
  std::function<void(int done, int total)> progress = {};
};

/// A force without an equilibrium, which gave no sample.
struct FailedTrial {
  long long contact = 0;  ///< id
  UnansweredForce trial;
  int not_tried = 0;  ///< forces that were left out because of it
};

struct SpecimenTrials {
  /// All contacts with samples. Ids of samples number the trials, with gaps for those left out;
  /// times are 0.
  Acquisition acquisition;
  std::vector<FailedTrial> failed;  ///< in the order of the plan
  int equilibria = 0;               ///< that were computed
};

/// Computes samples of a simulated object without an arm and without errors: at each contact, the
/// five normal forces of `base_forces`, and under each of them a drag in each direction of the
/// plan. Every second direction has a sample 2 % inside the friction cone, which held, and one 2 %
/// outside, which slipped and needs no equilibrium. The others hold 0.55 of the largest tangential
/// force. No force that holds exceeds `max_force` of the plan. If a normal force has no
/// equilibrium, larger ones are not tried. Contacts are computed in parallel; the result does not
/// depend on the number of threads.
/// \throws InvalidInput if the plan has no contact or no level; SolverError if no contact has a
/// sample, naming the first reason.
[[nodiscard]] SpecimenTrials try_specimen(const Specimen& specimen, const ContactPlan& plan,
                                          const SpecimenTrialOptions& options = {});

}  // namespace palpate::probing
