// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// The part of the baseline along each axis of the projector, in [0, 1]: the direction in which the
/// image of a point moves on the panel as the point moves along a ray of the camera.
[[nodiscard]] Eigen::Array2d parts_of_baseline(const Rig& rig);

/// Returns true if a sinusoid along this axis shows steps of depth: at least half of the baseline
/// lies along it.
[[nodiscard]] bool shows_steps(const Rig& rig, Axis axis);

}  // namespace palpate::sensing
