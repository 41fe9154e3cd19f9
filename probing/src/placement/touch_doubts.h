// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "palpate/geometry/registration.h"
#include "palpate/probing/touch_placement.h"

namespace palpate::probing {

/// Fewest touches with which a registration can be judged.
inline constexpr int kFewestTouches = 16;

/// Registers touches to the surface, from the rough pose or from everywhere.
[[nodiscard]] geometry::Registration search_touches(const Eigen::Matrix3Xd& tips,
                                                    const geometry::TriangleMesh& surface,
                                                    const geometry::RegistrationTarget& target,
                                                    const TouchPlacementOptions& options);

/// Returns why no pose puts these touches on the surface, for example because of another unit.
[[nodiscard]] std::optional<std::string> impossible_touches(const Eigen::Matrix3Xd& tips,
                                                            const geometry::TriangleMesh& surface);

/// If the touches do not fit, looks whether they would fit in another way: mirrored, on the other
/// side of the surface, in another unit, or from the inverse of the start pose. If so, the pose is
/// not determined, and the reason says why.
void explain_misfit(const Eigen::Matrix3Xd& tips, const geometry::TriangleMesh& surface,
                    const geometry::RegistrationTarget& target,
                    const TouchPlacementOptions& options, const geometry::Registration& found,
                    ArmPlacement& placement);

}  // namespace palpate::probing
