// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>

namespace palpate::bench {

/// Random colours of a print.
struct Inks {
  double darkest = 0;  ///< of full reflectance
  double tint = 0;     ///< 0: grey, 1: any colour
};

/// Rectangles of random colours, one over the other.
[[nodiscard]] cv::Mat print(const Inks& inks);

/// Square tiles of random colours, four pixels per mm. Upright strips of 90 mm, five of which are
/// in view, have tiles of 1/2, 1, 1 1/2, 2 and 3 periods, whose edges run along the sinusoid and
/// across it.
/// \param size   [mm] width and height.
/// \param period [mm] of the sinusoid.
[[nodiscard]] cv::Mat tiles(const Eigen::Vector2d& size, double period, const Inks& inks);

}  // namespace palpate::bench
