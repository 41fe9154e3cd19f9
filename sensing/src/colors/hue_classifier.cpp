// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "colors/hue_classifier.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "image/hue.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::sensing {
namespace {

/// Smallest deviation of a colour's hue [rad], because surfaces have their own colours.
constexpr double kLeastSurfaceDeviation = 0.06;

const TrainedColor& find_color(const TrainedColors& trained, const std::string& name) {
  const auto found = std::find_if(trained.colors.begin(), trained.colors.end(),
                                  [&](const TrainedColor& color) { return color.name == name; });
  if (found == trained.colors.end()) {
    std::string known;
    for (const TrainedColor& color : trained.colors)
      known += (known.empty() ? "" : ", ") + color.name;
    throw InvalidInput("trained colours: colour " + name + " of the pattern was never trained; " +
                       (known.empty() ? "there are none" : "there are " + known));
  }
  require("trained colours: colour " + name + ": mean", found->mean, finite(), "rad");
  require("trained colours: colour " + name + ": variance", found->variance, at_least(0).finite(),
          "rad^2");
  return *found;
}

}  // namespace

std::vector<HueSpread> trained_hues(const Pattern& pattern, const TrainedColors& trained) {
  std::vector<HueSpread> hues;
  for (const PatternColor& color : pattern.colors) {
    const TrainedColor& found = find_color(trained, color.name);
    hues.push_back({found.mean, std::max(std::sqrt(found.variance), kLeastSurfaceDeviation)});
  }
  return hues;
}

HueClassifier::HueClassifier(const Pattern& pattern, const TrainedColors& trained)
    : colors_(static_cast<int>(pattern.colors.size())),
      padded_((colors_ + kGroup - 1) / kGroup * kGroup) {
  const std::vector<HueSpread> hues = trained_hues(pattern, trained);
  const auto padded = static_cast<std::size_t>(padded_);
  table_.resize(kSteps * padded);
  std::vector<double> exponent(hues.size());
  for (std::size_t step = 0; step < kSteps; ++step) {
    const double hue = kFullTurn * (static_cast<double>(step) + 0.5) / kSteps;
    std::transform(hues.begin(), hues.end(), exponent.begin(), [&](const HueSpread& color) {
      const double distance = wrap(hue - color.mean) / color.deviation;
      return -0.5 * distance * distance - std::log(color.deviation);
    });
    // Relative to the largest, so that hues far from all colours do not cause 0 / 0.
    const auto largest = std::max_element(exponent.begin(), exponent.end());
    double sum = 0;
    for (const double e : exponent) sum += std::exp(e - *largest);
    for (std::size_t i = 0; i < exponent.size(); ++i) {
      table_[step * padded + i] = static_cast<float>(std::exp(exponent[i] - *largest) / sum);
    }
    best_.push_back(static_cast<int>(largest - exponent.begin()));
  }
}

}  // namespace palpate::sensing
