// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <span>

namespace palpate::probing {

/// Depth of a tip when its force passed a threshold.
struct TouchDepth {
  double depth = 0;                                  ///< [mm] below the place of zero force
  double deviation = 0;                              ///< [mm] standard deviation of it
  Eigen::Vector3d along = Eigen::Vector3d::UnitZ();  ///< direction of the approach
};

/// Extrapolates the beginning of a press to zero force, by lines of the position over force^p. The
/// exponents p from 2/3 (a ball on an elastic body, Hertz) to 1 (a spring) are weighted by how well
/// they fit. The deviation also includes the difference to the place from the first half of the
/// moments.
/// \param tips [mm] positions from the threshold on, while the force rises
/// \param forces [N] > 0, as many
/// \param touch [mm] where the force passed the threshold
/// \return nothing if there are fewer than six moments, if the force does not rise to twice the
/// threshold, or if the fit does not lead to a place above the touch.
[[nodiscard]] std::optional<TouchDepth> touch_depth(std::span<const Eigen::Vector3d> tips,
                                                    std::span<const double> forces,
                                                    const Eigen::Vector3d& touch, double threshold);

}  // namespace palpate::probing
