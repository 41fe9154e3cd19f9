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
  /// All contacts with samples. A sample's id tells its place in the programme; times are 0.
  Acquisition acquisition;
  std::vector<FailedTrial> failed;  ///< in the order of the plan
  int equilibria = 0;               ///< that were computed
};

/// What exact trials of a simulated object give, without an arm: the base of `AdaptiveTrials`, five
/// normal forces with each direction of the plan. A direction ends at the specimen's friction cone
/// or the most force of the plan: a sample 2 % inside the cone held, and one 2 % outside slipped,
/// which needs no equilibrium. Every second direction holds 0.55 of that instead. If a normal
/// force has no equilibrium, the contact's forces with it and above are not tried. Contacts are
/// computed in parallel; the result does not depend on the number of threads.
/// \throws InvalidInput if the plan has no contact or no level; SolverError if no contact has a
/// sample, naming the first reason.
[[nodiscard]] SpecimenTrials try_specimen(const Specimen& specimen, const ContactPlan& plan,
                                          const SpecimenTrialOptions& options = {});

}  // namespace palpate::probing
