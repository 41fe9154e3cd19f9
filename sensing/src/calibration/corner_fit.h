// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <opencv2/core/mat.hpp>
#include <optional>

namespace palpate::sensing {

/// A corner where four squares meet, in an image: its place, and directions along its two edges.
struct CornerGuess {
  Eigen::Vector2d place;     ///< px
  Eigen::Vector2d edges[2];  ///< along the edges, to the next corner or so [px]
  double radius = 0;         ///< px, of the circle in which the image is used
};

/// A corner where its image says it is.
struct CornerFit {
  Eigen::Vector2d place;  ///< px
  double blur = 0;        ///< px, standard deviation of the image's blur
};

/// Fits (c + a erf(d1 / s) erf(d2 / s)) (1 + g p), with the distances d from two curves through the
/// corner, a blur s and a gradient g of the light, to the pixels within a circle (Gauss-Newton).
///
/// This image is even about the corner, so that a response curve, glare or too small a circle do
/// not move it; the edges may be bent as by a lens, which would otherwise pull all corners towards
/// the middle of the image. Light that falls off across blurred edges moves them against its
/// gradient; this is corrected. On simulated boards residuals fall from 0.025 px of the balance of
/// gradients (`cornerSubPix`) to 0.003 px.
/// \param image CV_32F.
/// \return empty if the circle leaves the image, if there is no contrast, or if the fit does not
/// converge within 0.3 px of the guess.
[[nodiscard]] std::optional<CornerFit> fit_corner(const cv::Mat_<float>& image,
                                                  const CornerGuess& guess);

}  // namespace palpate::sensing
