// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::pictures {

/// Residuals of one view in one image.
struct ResidualView {
  std::string name;
  Eigen::Matrix2Xd at;        ///< 2 x N [px], y downwards
  Eigen::Matrix2Xd residual;  ///< 2 x N [px], one per point
};

/// An image, such as that of the camera or the panel of the projector.
struct ResidualImage {
  std::string title;
  int width = 0;   ///< px, > 0
  int height = 0;  ///< px, > 0
  std::vector<ResidualView> views;
};

/// Draws as a PNG of 1200 x 900 px one or two images side by side, with a line from each point
/// along its residual, much enlarged, and below the root mean square of each view. Works without a
/// display.
/// \throws InvalidInput, naming the image or view, if there is none, if points and residuals differ
/// in number, or one is not finite.
/// \throws OutputError if the picture cannot be written.
void draw_residuals(const std::filesystem::path& png, const std::vector<ResidualImage>& images,
                    const std::string& title);

}  // namespace palpate::pictures
