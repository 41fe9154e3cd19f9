// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <vector>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/trained_colors.h"

namespace palpate::sensing {

/// Bayesian classifier of hues: one Gaussian a colour (thesis 3.3.2, Eq. 3.4 with sigma^2 the
/// variance).
class HueClassifier {
 public:
  /// Probabilities are tabulated at so many hues around the circle.
  static constexpr int kSteps = 1024;

  /// Probabilities come in groups of so many colours, zeros filling the last one.
  static constexpr int kGroup = 8;

  /// \throws InvalidInput if a colour of the pattern was not trained.
  HueClassifier(const Pattern& pattern, const TrainedColors& trained);

  [[nodiscard]] int colors() const { return colors_; }
  /// A multiple of kGroup.
  [[nodiscard]] int padded_colors() const { return padded_; }
  /// Probability of each colour of the pattern (in its order) given the hue [rad, in [0, 2 pi)]:
  /// its density divided by the sum of all.
  [[nodiscard]] const float* probabilities(float hue) const {
    return &table_[static_cast<std::size_t>(step_of(hue) * padded_)];
  }
  /// Index of the most probable colour.
  [[nodiscard]] int best(float hue) const { return best_[static_cast<std::size_t>(step_of(hue))]; }
  /// The same in two steps.
  [[nodiscard]] static int step_of(float hue) {
    constexpr float kPerRadian = kSteps / (2 * std::numbers::pi_v<float>);
    const int step = static_cast<int>(hue * kPerRadian);
    const int positive = step > 0 ? step : 0;
    return positive < kSteps ? positive : kSteps - 1;
  }
  [[nodiscard]] const int* best_of_steps() const { return best_.data(); }

 private:
  int colors_ = 0;
  int padded_ = 0;
  std::vector<float> table_;  ///< kSteps x padded colours
  std::vector<int> best_;     ///< kSteps
};

}  // namespace palpate::sensing
