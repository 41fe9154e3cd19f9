// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/model.h"
#include "palpate/probing/acquisition.h"
#include "palpate/probing/campaign.h"
#include "palpate/probing/reference_probe.h"
#include "probing/arm_session.h"
#include "probing/probe_campaign.h"
#include "probing/report_page.h"

namespace palpate::apps {

/// A campaign and what was made of it.
struct CampaignReport {
  probing::Campaign campaign;
  std::vector<probing::TrialRecord> trials;  ///< at least one
  std::vector<probing::ReferenceProbe> references;
  CampaignFindings findings;
  probing::CampaignOptions options;
  std::string software;  ///< that performed them
  probing::CheckedAcquisition acquisition;
  haptics::Model model;
  std::optional<haptics::LeaveOneOut> left_out;  ///< none if the model has too few contacts
  std::optional<haptics::QueryErrors> queries;   ///< none if no forces are known
  std::optional<ArmSession> session;             ///< none without a record
};

/// The parts of its page, one heading each; their pictures go into the folder.
void add_summary(ReportPage& page, const CampaignReport& input);
void add_time_line(ReportPage& page, const fs::path& folder, const CampaignReport& input);
void add_displacements(ReportPage& page, const fs::path& folder, const CampaignReport& input);
void add_samples(ReportPage& page, const fs::path& folder, const CampaignReport& input);
void add_errors(ReportPage& page, const fs::path& folder, const CampaignReport& input);
void add_contact_table(ReportPage& page, const CampaignReport& input);

}  // namespace palpate::apps
