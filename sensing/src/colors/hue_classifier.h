// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <numbers>
#include <vector>

#include "palpate/sensing/pattern.h"
#include "palpate/sensing/trained_colors.h"

namespace palpate::sensing {

/// The hues of a colour of the pattern, as trained.
struct HueSpread {
  double mean = 0;       ///< [rad]
  double deviation = 0;  ///< [rad], at least 0.06: surfaces have their own colours
};
/// One per colour of the pattern, in its order.
/// \throws InvalidInput if a colour of the pattern was not trained, or its hues are not finite.
[[nodiscard]] std::vector<HueSpread> trained_hues(const Pattern& pattern,
                                                  const TrainedColors& trained);

/// Bayesian classifier of hues with one Gaussian per colour (thesis 3.3.2, Eq. 3.4 with sigma^2 the
/// variance).
class HueClassifier {
 public:
  /// Number of hues around the circle at which probabilities are tabulated.
  static constexpr int kSteps = 1024;

  /// The probabilities of a hue are padded with zeros to a multiple of this.
  static constexpr int kGroup = 8;

  /// \throws InvalidInput as `trained_hues` does.
  HueClassifier(const Pattern& pattern, const TrainedColors& trained);

  [[nodiscard]] int colors() const { return colors_; }
  /// Number of colours rounded up to a multiple of kGroup.
  [[nodiscard]] int padded_colors() const { return padded_; }
  /// Probability of each colour of the pattern, in its order, given the hue [rad, in [0, 2 pi)]:
  /// the density of the colour divided by the sum over all colours.
  [[nodiscard]] const float* probabilities(float hue) const {
    return &table_[static_cast<std::size_t>(step_of(hue) * padded_)];
  }
  /// Index of the most probable colour.
  [[nodiscard]] int best(float hue) const { return best_[static_cast<std::size_t>(step_of(hue))]; }
  /// Index of a hue's table entry; `best_of_steps()[step_of(hue)]` equals `best(hue)`.
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
