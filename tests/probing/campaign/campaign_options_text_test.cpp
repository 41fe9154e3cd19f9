// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/campaign_options_text.h"

#include <gtest/gtest.h>

#include <string>

#include "refusal.h"

namespace palpate::probing {
namespace {

TEST(CampaignOptionsText, GivesBackEachOption) {
  CampaignOptions options;
  options.strategy = TrialStrategy::adaptive;
  options.seed = 7;
  options.resolution = 0.25;
  options.reference_every = 9;
  options.max_hours = 1.5;
  options.program.force_noise = 1.0 / 3;
  const CampaignOptions read = parse_campaign_options(to_text(options), "a.db");
  EXPECT_EQ(read.strategy, TrialStrategy::adaptive);
  EXPECT_EQ(read.seed, 7U);
  EXPECT_EQ(read.resolution, 0.25);
  EXPECT_EQ(read.reference_every, 9);
  EXPECT_EQ(read.max_hours, 1.5);
  EXPECT_EQ(read.program.force_noise, 1.0 / 3);
  EXPECT_EQ(to_text(read), to_text(options));
}

TEST(CampaignOptionsText, NamesTheSourceAndWhatIsWrong) {
  std::string text = to_text(CampaignOptions{});
  text.replace(text.find("pooled"), 6, "random");
  EXPECT_EQ(refusal([&] { return parse_campaign_options(text, "a.db"); }),
            "a.db: the strategy 'random' is unknown");
  EXPECT_EQ(refusal([&] {
              return parse_campaign_options("{", "a.db");
            }).find("a.db: its strategy cannot be read: "),
            0U);
}

}  // namespace
}  // namespace palpate::probing
