// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/trained_colors.h"

namespace palpate::sensing {

/// The fully saturated colour of a hue [rad], value 1.
[[nodiscard]] Eigen::Vector3d rgb_of_hue(double hue);

/// `count` fully saturated hues at equal distances, the first one red. Colours are named R, Y, G,
/// C, B, M at multiples of 60 degrees, else H and the hue in whole degrees: H072.
/// \throws InvalidInput unless 2 <= count <= 24.
[[nodiscard]] std::vector<PatternColor> evenly_spaced_colors(int count);

/// Colours of a pattern and how the camera is expected to see them.
struct SpreadColors {
  std::vector<PatternColor> colors;    ///< in the order of their hues
  std::vector<TrainedColor> expected;  ///< predicted mean and variance of the hue; no pixels
};

/// Chooses projected hues so that the two neighbours the camera tells apart worst lie as far apart
/// as possible in units of their standard deviations: this minimises the overlap of the Gaussians,
/// as thesis 3.3.2 asks. What the camera sees of a projected hue is interpolated linearly between
/// the trained colours, mean and deviation, around the circle. Of equally good choices it takes the
/// one nearest to the trained hues, where least is interpolated. Hues are whole degrees. If as many
/// colours are wanted as were trained, and no two of those overlap by more than 1e-4, they stay as
/// they are: nothing is to be gained.
///
/// \param trained names as in `evenly_spaced_colors`, which tell what was projected.
/// \throws InvalidInput unless 2 <= count <= 24, there are at least 3 trained colours with such
/// names and variances >= 0, and the camera sees them in the order in which they were projected.
[[nodiscard]] SpreadColors spread_colors(const TrainedColors& trained, int count);

/// How far two classes lie apart: |circular difference of the means| / (sum of the deviations). At
/// the threshold that lies equally many deviations from both means, each is taken for the other
/// with the probability 1/2 erfc(d / sqrt 2).
/// \return n x n, zero on the diagonal.
[[nodiscard]] Eigen::MatrixXd hue_separation(const std::vector<TrainedColor>& colors);

/// The largest of these probabilities over all pairs of classes.
[[nodiscard]] double largest_overlap(const std::vector<TrainedColor>& colors);

}  // namespace palpate::sensing
