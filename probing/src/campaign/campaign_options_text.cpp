// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/campaign_options_text.h"

#include <nlohmann/json.hpp>
#include <string>

#include "palpate/core/error.h"

namespace palpate::probing {
namespace {

using Json = nlohmann::ordered_json;

// Visits the members of the options, both for reading and for writing.
template <typename Options, typename Visit>
void visit_campaign_options(Options& o, Visit&& visit) {
  visit("seed", o.seed);
  visit("resolution", o.resolution);
  visit("cautious", o.cautious);
  visit("friction_accuracy", o.friction_accuracy);
  visit("most_failures", o.most_failures);
  visit("clearance", o.program.clearance);
  visit("travel_limit", o.program.travel_limit);
  visit("touch_limit", o.program.touch_limit);
  visit("settle_limit", o.program.settle_limit);
  visit("lift_limit", o.program.lift_limit);
  visit("position_noise", o.program.position_noise);
  visit("force_noise", o.program.force_noise);
}

// Members that stores of campaigns without limits do not have.
template <typename Options, typename Visit>
void visit_limits(Options& o, Visit&& visit) {
  visit("until", o.until);
  visit("max_hours", o.max_hours);
  visit("max_samples", o.max_samples);
}

constexpr const char* kReferenceEvery = "reference_every";  // older stores do not have it

TrialStrategy strategy_of(const std::string& name, const std::string& source) {
  for (const TrialStrategy each :
       {TrialStrategy::pooled, TrialStrategy::bisection, TrialStrategy::adaptive}) {
    if (name == to_string(each)) return each;
  }
  throw FileError(source + ": the strategy '" + name + "' is unknown");
}

}  // namespace

std::string to_text(const CampaignOptions& options) {
  Json json{{"strategy", to_string(options.strategy)}};
  const auto write = [&](const char* name, const auto& value) { json[name] = value; };
  visit_campaign_options(options, write);
  if (options.strategy == TrialStrategy::adaptive) visit_limits(options, write);
  write(kReferenceEvery, options.reference_every);
  return json.dump();
}

CampaignOptions parse_campaign_options(const std::string& text, const std::string& source) {
  CampaignOptions options;
  try {
    const Json json = Json::parse(text);
    options.strategy = strategy_of(json.at("strategy").get<std::string>(), source);
    visit_campaign_options(options,
                           [&](const char* name, auto& value) { json.at(name).get_to(value); });
    visit_limits(options, [&](const char* name, auto& value) {
      if (json.contains(name)) json.at(name).get_to(value);
    });
    options.reference_every = json.value(kReferenceEvery, 0);
  } catch (const Json::exception& wrong) {
    throw FileError(source + ": its strategy cannot be read: " + wrong.what());
  }
  return options;
}

}  // namespace palpate::probing
