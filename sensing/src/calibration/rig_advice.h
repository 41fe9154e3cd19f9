// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "calibration/rig_fit.h"
#include "palpate/sensing/rig.h"

namespace palpate::sensing {

/// The parameters that the views determine badly, one sentence each: the parameter, its standard
/// deviation, and which pose of the board to add. Empty if there are none.
/// \param deviation of the rig's parameters, in the order of `RigCovariance`.
[[nodiscard]] std::vector<std::string> rig_advice(const RigFit& fit,
                                                  const Eigen::VectorXd& deviation);

/// One sentence for each view in which several corners do not lie in the plane of the others: the
/// board is not flat, or something hides them. They count less in the fit.
[[nodiscard]] std::vector<std::string> uneven_boards(const RigFit& fit,
                                                     const std::vector<RigView>& views);

/// Median standard deviation that the rig's covariance gives to depths, as a share of the depth:
/// over the camera's image, where the projector lights it, at the distances of the boards.
/// \pre the rig has a covariance.
[[nodiscard]] double relative_depth_deviation(const Rig& rig, const RigFit& fit);

}  // namespace palpate::sensing
