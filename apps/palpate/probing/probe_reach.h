// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/probing/arm_reach.h"
#include "palpate/probing/contact_plan.h"
#include "probing/probe_arm.h"

namespace palpate::apps {

/// Which contacts an arm can probe. `surface_path` is the surface of a real object, or empty; a
/// device without it is warned of.
/// \throws InvalidInput if the plan is of another surface.
[[nodiscard]] probing::PlanReach reach_of_arm(const CampaignArm& arm,
                                              const probing::ContactPlan& plan,
                                              const fs::path& plan_path,
                                              const fs::path& surface_path);

/// \throws InvalidInput as `reach_of_arm`, or naming the contacts that the arm cannot probe.
void check_reach(const CampaignArm& arm, const probing::ContactPlan& plan,
                 const fs::path& plan_path, const fs::path& surface_path);

}  // namespace palpate::apps
