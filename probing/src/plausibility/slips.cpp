// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <utility>

#include "plausibility/presses.h"

namespace palpate::probing {
namespace {

struct SlipOrder {
  double pairs = 0;   ///< of a slipped and a held sample
  double larger = 0;  ///< pairs in which the slipped one has the larger ratio; ties count half
};

SlipOrder slip_order(const Presses& presses) {
  std::vector<std::pair<double, bool>> ratios;
  for (const Press& press : presses) {
    if (press.normal != 0)
      ratios.emplace_back(tangential_over_normal(press), press.sample->slipped);
  }
  std::ranges::sort(ratios);
  SlipOrder order;
  double held = 0, slipped = 0;  // among smaller ratios
  for (std::size_t i = 0; i < ratios.size();) {
    double held_here = 0, slipped_here = 0;
    for (const double ratio = ratios[i].first; i < ratios.size() && ratios[i].first == ratio; ++i)
      (ratios[i].second ? slipped_here : held_here) += 1;
    order.larger += slipped_here * (held + held_here / 2);
    held += held_here;
    slipped += slipped_here;
  }
  order.pairs = held * slipped;
  return order;
}

}  // namespace

void find_slips(const std::vector<ProbedContact>& contacts, std::vector<Finding>& findings) {
  const char* const kMeaning =
      "slipped is 1 where the tool slid and 0 where it held; check the column";
  SlipOrder all;
  std::vector<long long> reversed;
  bool any_held = false;
  for (const ProbedContact& probed : contacts) {
    const SlipOrder here = slip_order(probed.presses);
    all.pairs += here.pairs;
    all.larger += here.larger;
    if (here.pairs >= kFewestSlipPairs && here.larger < kReversedSlips * here.pairs)
      reversed.push_back(probed.contact->id);
    any_held = any_held || std::ranges::any_of(probed.presses, [](const Press& press) {
                 return !press.sample->slipped;
               });
  }
  if (!any_held) {
    findings.push_back({Implausibility::all_slipped, false,
                        "every sample is marked as slipped, so that no tool position b is used",
                        kMeaning});
    return;
  }
  if (all.pairs < kFewestSlipPairs) return;
  const double share = all.larger / all.pairs;
  if (share < kReversedSlips || !reversed.empty()) {
    findings.push_back(
        {Implausibility::slips_reversed, share < kReversedSlips,
         "samples that slipped have smaller tangential forces, relative to their normal force, "
         "than samples that held" +
             (reversed.empty() ? std::string() : " at " + named("contact", reversed)),
         kMeaning});
  } else if (share < kUnrelatedSlips) {
    findings.push_back(
        {Implausibility::slips_unrelated, false,
         "only " + percent(share) +
             " of the samples that slipped have a larger tangential force, relative to the normal "
             "force, than one that held at the same contact; without any relation it is 50 %",
         kMeaning});
  }
}

}  // namespace palpate::probing
