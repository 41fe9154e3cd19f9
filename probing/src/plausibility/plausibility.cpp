// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/plausibility.h"

#include <algorithm>

#include "plausibility/presses.h"

namespace palpate::probing {

const char* to_string(Implausibility kind) {
  switch (kind) {
    case Implausibility::forces_reversed:
      return "forces_reversed";
    case Implausibility::normals_inwards:
      return "normals_inwards";
    case Implausibility::tool_outside:
      return "tool_outside";
    case Implausibility::pulling_samples:
      return "pulling_samples";
    case Implausibility::outside_samples:
      return "outside_samples";
    case Implausibility::exchanged_ends:
      return "exchanged_ends";
    case Implausibility::mixed_groups:
      return "mixed_groups";
    case Implausibility::scattered_groups:
      return "scattered_groups";
    case Implausibility::length_units:
      return "length_units";
    case Implausibility::distant_tool:
      return "distant_tool";
    case Implausibility::length_scale:
      return "length_scale";
    case Implausibility::force_scale:
      return "force_scale";
    case Implausibility::tilted_forces:
      return "tilted_forces";
    case Implausibility::slips_reversed:
      return "slips_reversed";
    case Implausibility::slips_unrelated:
      return "slips_unrelated";
    case Implausibility::all_slipped:
      return "all_slipped";
  }
  return "";
}

std::string message(const Finding& finding) { return finding.what + "; " + finding.right; }

std::vector<Finding> find_implausible(const CheckedAcquisition& acquisition) {
  const std::vector<ProbedContact> contacts = probed_contacts(acquisition);
  std::vector<Finding> findings;
  if (contacts.empty()) return findings;
  find_length_units(contacts, findings);
  // Positions in another unit have no side.
  const auto impossible = [&] { return std::ranges::any_of(findings, &Finding::impossible); };
  if (!impossible()) {
    find_signs(contacts, findings);
    find_single_samples(contacts, findings);
  }
  if (!impossible()) find_exchanged_ends(contacts, findings);
  find_groups(contacts, findings);
  find_scales(contacts, findings);
  find_slips(contacts, findings);
  std::ranges::stable_sort(findings, {}, &Finding::kind);
  return findings;
}

}  // namespace palpate::probing
