// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "friction/load_estimate.h"
#include "palpate/haptics/friction_cone.h"
#include "palpate/probing/acquisition.h"

namespace palpate::haptics {

struct ContactCones {
  std::vector<FrictionFit> cones;  ///< by contact, in the frame of the acquisition
  /// If the friction of the object depends on the load: how. The cones hold at its reference force.
  std::optional<FrictionLoadEstimate> load = std::nullopt;
};

/// Fits the friction cones of contacts of an acquisition, and how friction depends on the load. If
/// no directions were searched, the cones of the other contacts are the prior. If the radius of the
/// ball that touched is known and trials have a steady error, standard errors and lower bounds hold
/// for the friction of the material as well: a ball in a dent slips at larger forces.
/// \param source their indices in the acquisition.
[[nodiscard]] ContactCones fit_contact_cones(const probing::CheckedAcquisition& acquisition,
                                             std::span<const std::size_t> source,
                                             const FrictionOptions& options);

}  // namespace palpate::haptics
