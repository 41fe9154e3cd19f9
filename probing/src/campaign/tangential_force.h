// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "campaign/adaptive_site.h"

namespace palpate::probing {

/// [N] The tangential force along a unit vector that slips with this probability under a normal
/// force [N], or the largest one that the arm may add.
[[nodiscard]] double force_for(const AdaptiveSite& site, const AdaptiveSetting& setting,
                               double normal, const Eigen::Vector3d& along, double probability);

/// [N] The largest tangential force that is held with the smallest plausible coefficient.
[[nodiscard]] double surely_held(const AdaptiveSite& site, const AdaptiveSetting& setting,
                                 double normal, const Eigen::Vector3d& along);

}  // namespace palpate::probing
