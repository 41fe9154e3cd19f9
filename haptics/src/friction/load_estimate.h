// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>
#include <vector>

#include "palpate/haptics/friction_cone.h"

namespace palpate::haptics {

/// The trials of a contact, and the cone that was fitted to them without regard to the load.
struct LoadedContact {
  std::vector<FrictionTrial> trials;
  FrictionFit cone;
};

/// Estimates how the friction of all contacts together depends on the load, if their trials show
/// it: one exponent p for the object, with a cone for each contact. It maximises the likelihood of
/// `fit_friction` over p and all cones. p is used only if it raises the log-likelihood by more than
/// half the logarithm of the number of trials (Bayesian information criterion), over no dependence
/// with any steady error of the tangential force, whose prior has the standard deviation
/// `FrictionOptions::steady_error`: a constant error looks like friction that falls with the load.
/// The reference force is the median of the normal forces.
/// \return none if the trials show no dependence, or one beyond `kLargestLoadExponent`.
[[nodiscard]] std::optional<FrictionLoadEstimate> estimate_friction_load(
    std::span<const LoadedContact> contacts, const FrictionOptions& options);

}  // namespace palpate::haptics
