// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::pictures {

/// Distribution of the hues that are seen of one colour.
struct HueDistribution {
  std::string name;
  double mean = 0;            ///< rad, in [0, 2 pi)
  double deviation = 0;       ///< rad, >= 0
  Eigen::VectorXd histogram;  ///< counts, from hue 0 around the circle in equal steps
};

/// Draws as a PNG of 1200 x 700 px, for each colour and in its hue: the histogram as a thin line
/// and the Gaussian around the circle as a thick one, both as densities. Works without a display.
/// \throws InvalidInput, naming the colour, if there is no colour, a number is not finite, or a
/// histogram is empty.
/// \throws OutputError if the picture cannot be written.
void draw_hues(const std::filesystem::path& png, const std::vector<HueDistribution>& hues,
               const std::string& title);

}  // namespace palpate::pictures
