// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/sensing/rig.h"
#include "palpate/sensing/rig_calibration.h"

namespace palpate::extremes {

/// A camera and a projector that see boards.
[[nodiscard]] sensing::Rig rig_of_boards();

/// Exact pixels of a board of 9 x 6 corners in that rig, in poses that are tilted about axes all
/// around.
/// \param tilt [rad]
[[nodiscard]] std::vector<sensing::RigView> views_of_board(int poses, double tilt);

}  // namespace palpate::extremes
