// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/campaign_options.h"

#include <array>
#include <cstddef>
#include <string_view>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/core/idle_fields.h"

namespace palpate::probing {
namespace {

constexpr std::array<std::string_view, 3> kStrategies{"pooled", "bisection", "adaptive"};

}  // namespace

const char* to_string(TrialStrategy strategy) {
  return kStrategies[static_cast<std::size_t>(strategy)].data();
}

void visit(CampaignOptions& options, FieldVisitor& visitor) {
  constexpr Interval kPositive = above(0).finite();
  visitor.begin("CampaignOptions");
  visitor.choice({"strategy",
                  "Choice of tangential forces: pooled, where they tell most about friction, with "
                  "what other contacts have shown; bisection, the interval in each direction is "
                  "halved; adaptive, where trials reduce the error of the model most per second, "
                  "until a limit"},
                 options.strategy, kStrategies);
  visitor.real({"resolution", "With bisection: interval of forces at which it ends", "N"},
               options.resolution, kPositive);
  visitor.real({"friction_accuracy",
                "With pooled and adaptive: standard deviation of a contact's coefficient at which "
                "no force is tried for friction alone"},
               options.friction_accuracy, kPositive);
  visitor.real(
      {"until", "With adaptive: stated error of the model at which to stop; 0: no limit", "N"},
      options.until, at_least(0).finite());
  visitor.real({"max_hours", "With adaptive: largest time of the arm; 0: no limit", "hours"},
               options.max_hours, at_least(0).finite());
  visitor.whole({"max_samples", "With adaptive: largest number of samples; 0: no limit"},
                options.max_samples, at_least(0));
  visitor.whole({"reference_every",
                 "Samples from one reference probe to the next: the same press at the first "
                 "contact, to see whether the object or the arm changes; 0: none"},
                options.reference_every, at_least(0));
  visitor.whole({"seed", "Seed of the order of directions, and of the errors of a simulated arm"},
                options.seed, at_least(0));

  constexpr bool kExpert = true;
  visitor.real({"cautious",
                "Probability of slipping of a trial that searches friction, with pooled and "
                "adaptive",
                "", kExpert},
               options.cautious, above(0).at_most(0.5));
  visitor.whole({"most_failures",
                 "Trials in a row that end a contact if nothing was touched, or the tip did not "
                 "come to rest",
                 "", kExpert},
                options.most_failures, at_least(1));
  ProgramOptions& program = options.program;
  visitor.real({"clearance", "Height above the surface in which the tip travels", "mm", kExpert},
               program.clearance, kPositive);
  visitor.real({"travel_limit", "Longest time of a travel", "s", kExpert}, program.travel_limit,
               above(0));
  visitor.real({"touch_limit", "Longest time of an approach", "s", kExpert}, program.touch_limit,
               above(0));
  visitor.real({"settle_limit", "Longest time that the tip takes to rest", "s", kExpert},
               program.settle_limit, above(0));
  visitor.real({"lift_limit", "Longest time of a lift", "s", kExpert}, program.lift_limit,
               above(0));
  visitor.real({"position_noise", "Standard deviation of a measured coordinate", "mm", kExpert},
               program.position_noise, kPositive);
  visitor.real(
      {"force_noise", "Standard deviation of a component of an applied force", "N", kExpert},
      program.force_noise, kPositive);
}

void check_campaign_options(const CampaignOptions& options) {
  static_cast<void>(in_range(options));
  const bool is_limited = options.until > 0 || options.max_hours > 0 || options.max_samples > 0;
  const bool is_adaptive = options.strategy == TrialStrategy::adaptive;
  if (options.strategy == TrialStrategy::bisection)
    refuse_idle(options, "strategy", {"friction_accuracy", "cautious"});
  else
    refuse_idle(options, "strategy", {"resolution"});
  if (is_adaptive == is_limited) return;
  using Parts = std::vector<MessagePart>;
  const MessagePart strategy{"CampaignOptions::strategy", true},
      until{"CampaignOptions::until", true}, hours{"CampaignOptions::max_hours", true},
      samples{"CampaignOptions::max_samples", true};
  if (is_adaptive) {
    throw InvalidInput(
        Parts{strategy, {" adaptive needs a limit: "}, until, {", "}, hours, {" or "}, samples});
  }
  throw InvalidInput(Parts{until,
                           {", "},
                           hours,
                           {" and "},
                           samples,
                           {" are of "},
                           strategy,
                           {" adaptive; the others end when their plan is done"}});
}

}  // namespace palpate::probing
