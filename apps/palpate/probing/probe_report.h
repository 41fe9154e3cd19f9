// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "probing/campaign_report.h"

namespace palpate::apps {

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
