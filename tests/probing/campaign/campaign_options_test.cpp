// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/campaign_options.h"

#include <gtest/gtest.h>

#include "refusal.h"

namespace palpate::probing {
namespace {

TEST(CampaignOptions, NeedALimitWithAdaptiveAlone) {
  using enum TrialStrategy;
  const auto refused = [](const CampaignOptions& options) {
    return refusal([&] { check_campaign_options(options); });
  };
  EXPECT_EQ(refused({.strategy = adaptive}),
            "CampaignOptions::strategy adaptive needs a limit: CampaignOptions::until, "
            "CampaignOptions::max_hours or CampaignOptions::max_samples");
  for (const TrialStrategy other : {pooled, bisection}) {
    EXPECT_NO_THROW(check_campaign_options({.strategy = other}));
    for (CampaignOptions limited : {CampaignOptions{.until = 0.1}, CampaignOptions{.max_hours = 1},
                                    CampaignOptions{.max_samples = 9}}) {
      limited.strategy = other;
      EXPECT_EQ(refused(limited),
                "CampaignOptions::until, CampaignOptions::max_hours and "
                "CampaignOptions::max_samples are of CampaignOptions::strategy adaptive; the "
                "others end when their plan is done");
      limited.strategy = adaptive;
      EXPECT_NO_THROW(check_campaign_options(limited));
    }
  }
}

TEST(CampaignOptions, OfTheProgramAreInTheList) {
  CampaignOptions options;
  options.program.travel_limit = 0;
  EXPECT_EQ(refusal([&] { check_campaign_options(options); }),
            "CampaignOptions::travel_limit is 0 s; it must be > 0");
}

}  // namespace
}  // namespace palpate::probing
