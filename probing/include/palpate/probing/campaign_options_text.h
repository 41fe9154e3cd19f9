// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "palpate/probing/campaign.h"

namespace palpate::probing {

/// The options of a campaign as text, and back.
[[nodiscard]] std::string to_text(const CampaignOptions& options);
/// \throws FileError naming `source` and the member that is wrong.
[[nodiscard]] CampaignOptions parse_campaign_options(const std::string& text,
                                                     const std::string& source);

}  // namespace palpate::probing
