// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/plausible.h"

#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/probing/acquisition_store.h"
#include "palpate/probing/plausibility.h"
#include "shared/field_options.h"

namespace palpate::apps {

void warn(Json& warnings, const std::string& kind, const std::string& message) {
  spdlog::warn("{}.", message);
  warnings.push_back({{"kind", kind}, {"message", message}});
}

void check_plausible(const std::string& source, const probing::CheckedAcquisition& acquisition,
                     Json& warnings) {
  std::string impossible;
  for (const probing::Finding& finding : probing::find_implausible(acquisition)) {
    if (finding.impossible)
      impossible += (impossible.empty() ? "" : ". Also, ") + probing::message(finding);
    else
      warn(warnings, probing::to_string(finding.kind),
           source + ": suspicious: " + probing::message(finding));
  }
  if (!impossible.empty())
    throw InvalidInput(source + ": these cannot be measurements of an object: " + impossible +
                       ". docs/measurements.md describes the columns.");
}

geometry::TriangleMesh surface_of_contacts(const probing::CheckedAcquisition& acquisition,
                                           const std::string& source, Json& warnings,
                                           probing::ContactSurfaceOptions options) {
  options.tip_radius = acquisition.records().probe_radius.value_or(options.tip_radius);
  probing::ContactSurface made = with_names({{"contact_surface()", source}}, [&] {
    return probing::contact_surface(acquisition.contacts(), options);
  });
  for (const probing::ContactMisfit& contact : made.left_out) {
    warn(warnings, "left_out_of_surface",
         "the surface is made without contact " + std::to_string(contact.id) + ": it " +
             contact.reason);
  }
  return std::move(made.mesh);
}

probing::CheckedAcquisition read_plausible_acquisition(const fs::path& store, Json& warnings) {
  probing::CheckedAcquisition acquisition = probing::read_acquisition(store);
  check_plausible(store.string(), acquisition, warnings);
  return acquisition;
}

}  // namespace palpate::apps
