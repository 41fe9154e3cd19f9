// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/probing/arm_prober.h"
#include "palpate/probing/campaign.h"
#include "probing/report_page.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// The content of a record of an arm besides the trials.
struct ArmSession {
  std::vector<probing::HeldPose> poses;  ///< at which gravity was measured
  probing::GravityModel gravity;
  probing::TrialOrder touched;  ///< the trial whose touch is shown
  probing::ArmApproach touch;
  /// Of the first trials; empty if the arm measures no reference force.
  std::vector<probing::AppliedForce> forces;
};

/// Replays the measurement of gravity, the first trial that touched a contact and, if there is a
/// reference force, the first trials of the campaign.
/// \throws FileError, or InvalidInput if no trial touched it or the record is of another campaign.
[[nodiscard]] ArmSession read_session(const fs::path& record, const probing::Campaign& campaign,
                                      const probing::CampaignOptions& options,
                                      const std::vector<probing::TrialRecord>& trials,
                                      long long contact);

/// Adds the touch, the compensation of gravity and the errors of forces to a page; their pictures
/// go into the folder.
void add_arm(ReportPage& page, const fs::path& folder, const ArmSession& session);

}  // namespace palpate::apps
