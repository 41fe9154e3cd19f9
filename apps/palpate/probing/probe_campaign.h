// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "palpate/probing/arm_reach.h"
#include "palpate/probing/campaign.h"
#include "palpate/probing/campaign_store.h"
#include "palpate/probing/contact_plan.h"
#include "palpate/probing/rate_dependence.h"
#include "palpate/probing/reference_probe.h"
#include "probing/probe_arm.h"
#include "probing/probe_camera.h"

namespace palpate::apps {

inline constexpr double kSecondsPerHour = 3600;

/// A campaign with the arm that performs it.
struct RunningCampaign {
  probing::Campaign campaign;
  std::unique_ptr<CampaignArm> arm;
  std::unique_ptr<CampaignCamera> camera = nullptr;  ///< of this arm, if one looks at it
};

/// Returns the state of a stored campaign: repeats the stored trials without an arm.
/// \param source names the store in messages.
/// \throws FileError if the trials are not those that the plan and the options order.
[[nodiscard]] probing::Campaign replayed(const probing::CampaignStore& store,
                                         const std::string& source);

/// Findings of the trials about the object and the arm, besides the samples.
struct CampaignFindings {
  probing::RateDependence rates;
  probing::ReferenceDrift drift;
  bool has_camera = false;
  int range_maps = 0;               ///< number that samples have
  std::vector<long long> not_seen;  ///< trials with unusable pictures
};
/// \throws FileError if the store cannot be read.
[[nodiscard]] CampaignFindings findings_of(const probing::CampaignStore& store,
                                           const probing::ContactPlan& plan,
                                           const probing::CampaignOptions& options);

/// The output of `probe run` and `probe status`, with and without --json.
[[nodiscard]] Json campaign_figures(const probing::Campaign& campaign,
                                    const probing::CampaignOptions& options,
                                    const CampaignFindings& findings);
[[nodiscard]] std::string campaign_words(const probing::Campaign& campaign,
                                         const probing::CampaignOptions& options,
                                         const CampaignFindings& findings);

/// Describes measurements that a quasi-static model does not show; empty if there are none.
[[nodiscard]] std::string beyond_statics(const probing::RateDependence& rates);

/// States that the displacement under the reference force changed; empty if that is not certain.
[[nodiscard]] std::string beyond_steadiness(const probing::ReferenceDrift& drift);

/// Explains a target that is not reached; empty if there is nothing to explain.
[[nodiscard]] std::string beyond_reach(const probing::CampaignProgress& at,
                                       const probing::CampaignOptions& options);

/// "5 trials are kept"
[[nodiscard]] std::string trials_kept(const probing::Campaign& campaign);

/// Performs and stores reference probes and trials until the campaign is complete, or `most`
/// trials.
void perform_trials(probing::CampaignStore& store, RunningCampaign& running,
                    const probing::CampaignOptions& options,
                    int most = std::numeric_limits<int>::max());

/// Determines the contacts that an arm can probe. `surface_path` is the surface of a real object,
/// or empty; for a device without it there is a warning.
/// \throws InvalidInput if the plan is of another surface.
[[nodiscard]] probing::PlanReach reach_of_arm(const CampaignArm& arm,
                                              const probing::ContactPlan& plan,
                                              const fs::path& plan_path,
                                              const fs::path& surface_path);

/// \throws InvalidInput as `reach_of_arm`, or naming the contacts that the arm cannot probe.
void check_reach(const CampaignArm& arm, const probing::ContactPlan& plan,
                 const fs::path& plan_path, const fs::path& surface_path);

}  // namespace palpate::apps
