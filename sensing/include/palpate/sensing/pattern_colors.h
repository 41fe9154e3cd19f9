// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/trained_colors.h"

namespace palpate::sensing {

/// The fully saturated colour with a hue [rad] and the value 1.
[[nodiscard]] Eigen::Vector3d rgb_of_hue(double hue);

/// Makes `count` fully saturated colours at equal hue distances, starting with red. They are named
/// R, Y, G, C, B, M at multiples of 60 degrees, otherwise H and the hue in whole degrees: H072.
/// \throws InvalidInput unless 2 <= count <= 24.
[[nodiscard]] std::vector<PatternColor> evenly_spaced_colors(int count);

/// Colours of a pattern and the hues that the camera is expected to see.
struct SpreadColors {
  std::vector<PatternColor> colors;    ///< in the order of their hues
  std::vector<TrainedColor> expected;  ///< predicted mean and variance of the hue; no pixels
};

/// Chooses hues to project so that the smallest separation of neighbouring hues in the camera, in
/// units of their standard deviations, becomes as large as possible. This minimises the overlap of
/// the Gaussians (thesis 3.3.2).
///
/// The camera's hue and deviation are interpolated linearly between the trained colours around the
/// circle. Hues are whole degrees. Among equally good choices the one nearest to the trained hues
/// is taken, since it needs the least interpolation. If `count` equals the number of trained
/// colours and no two of them overlap by more than 1e-4, the trained colours are returned
/// unchanged.
/// \param trained names as in `evenly_spaced_colors`; they state which hue was projected.
/// \throws InvalidInput unless 2 <= count <= 24, at least 3 trained colours have such names and
/// variances >= 0, and the camera sees them in the order in which they were projected.
[[nodiscard]] SpreadColors spread_colors(const TrainedColors& trained, int count);

/// Separation of each pair of classes: |circular difference of the means| / (sum of the standard
/// deviations). With a threshold the same number of deviations from both means, each class is
/// mistaken for the other with the probability 1/2 erfc(d / sqrt 2).
/// \return n x n, zero on the diagonal.
[[nodiscard]] Eigen::MatrixXd hue_separation(const std::vector<TrainedColor>& colors);

/// The largest of these probabilities over all pairs of classes.
[[nodiscard]] double largest_overlap(const std::vector<TrainedColor>& colors);

}  // namespace palpate::sensing
