// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

#include "calibration/rig_fit.h"

namespace palpate::sensing {

/// A movement of camera and projector against each other between two views.
struct RigMove {
  std::size_t views_before = 0;
  double apart_rms = 0;  ///< px, of the projector, if both groups are fitted each alone
};

/// Finds whether views fall into two groups, one after the other, that fit much better each alone
/// than together.
/// \param fit of all of `views`, in the order in which they were taken.
/// \param least_views of a group.
/// \param fit_again fits some of the views; may throw SolverError.
[[nodiscard]] std::optional<RigMove> find_move(
    const RigFit& fit, const std::vector<RigView>& views, std::size_t least_views,
    const std::function<RigFit(const std::vector<RigView>&)>& fit_again);

/// Root of the mean squared length of the residuals in the projector [px], all with equal weight.
[[nodiscard]] double projector_rms(const RigFit& fit);

}  // namespace palpate::sensing
