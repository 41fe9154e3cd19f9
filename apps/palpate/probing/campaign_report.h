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
#include "probing/report_stiffness.h"

namespace palpate::apps {

/// A campaign and its results.
struct CampaignReport {
  probing::Campaign campaign;
  std::vector<probing::TrialRecord> trials;  ///< at least one
  std::vector<probing::ReferenceProbe> references;
  CampaignFindings findings;
  probing::CampaignOptions options;
  std::string software;  ///< program that performed them
  probing::CheckedAcquisition acquisition;
  haptics::Model model;
  std::optional<ReportedStiffness> stiffness;    ///< none if the campaign has too few contacts
  std::optional<haptics::LeaveOneOut> left_out;  ///< none if the model has too few contacts
  std::optional<haptics::QueryErrors> queries;   ///< none if no forces are known
  std::optional<ArmSession> session;             ///< none without a record
};

/// Reads a campaign, the model that was fitted to it, and known forces.
/// \param queries may be empty: no forces are known.
/// \param record of the arm that performed the campaign; may be empty.
/// \throws FileError, or InvalidInput if there is no trial, or the model or the record is of another
/// campaign.
[[nodiscard]] CampaignReport read_report(const fs::path& store, const fs::path& model,
                                         const fs::path& queries, const fs::path& record = {});

/// Writes a page with tables and pictures, `index.html`, and its pictures into a folder.
/// \throws OutputError if it cannot be written, InvalidInput if it holds other files.
void write_report(const fs::path& folder, const CampaignReport& report);

}  // namespace palpate::apps
