// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/color_overlap.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "colors/hue_classifier.h"
#include "colors/training_hues.h"
#include "palpate/core/error.h"
#include "palpate/core/require.h"

namespace palpate::sensing {
namespace {

/// The classifier of a pattern with all trained colours.
HueClassifier make_classifier(const TrainedColors& trained) {
  if (trained.colors.empty()) throw InvalidInput("trained colours: there are none");
  Pattern pattern;
  for (const TrainedColor& color : trained.colors)
    pattern.colors.push_back({color.name, Eigen::Vector3d::UnitX()});
  return {pattern, trained};
}

/// Share of a Gaussian around the circle between two angles [rad].
double share_between(const TrainedColor& color, double low, double high) {
  const double deviation = std::sqrt(color.variance);
  const auto below = [&](double angle) {
    if (!(deviation > 0)) return angle < color.mean ? 0.0 : 1.0;
    return 0.5 * std::erfc((color.mean - angle) / (deviation * std::numbers::sqrt2));
  };
  double share = 0;
  constexpr int kTurns = 2;  // the deviation of a hue is far below two turns
  for (int turn = -kTurns; turn <= kTurns; ++turn) {
    const double shift = 2 * std::numbers::pi * turn;
    share += below(high + shift) - below(low + shift);
  }
  return share;
}

}  // namespace

Eigen::MatrixXd predict_overlap(const TrainedColors& trained) {
  const HueClassifier classifier = make_classifier(trained);
  const auto count = static_cast<Eigen::Index>(trained.colors.size());
  Eigen::MatrixXd overlap = Eigen::MatrixXd::Zero(count, count);
  const double width = 2 * std::numbers::pi / HueClassifier::kSteps;
  for (int step = 0; step < HueClassifier::kSteps; ++step) {
    const int taken_for = classifier.best(static_cast<float>((step + 0.5) * width));
    for (Eigen::Index i = 0; i < count; ++i) {
      overlap(i, taken_for) += share_between(trained.colors[static_cast<std::size_t>(i)],
                                             step * width, (step + 1) * width);
    }
  }
  for (Eigen::Index i = 0; i < count; ++i) overlap.row(i) /= overlap.row(i).sum();
  return overlap;
}

Eigen::MatrixXd measure_overlap(const std::vector<NamedImages>& images,
                                const TrainedColors& trained, const TrainingOptions& options) {
  const HueClassifier classifier = make_classifier(trained);
  const auto count = static_cast<Eigen::Index>(trained.colors.size());
  Eigen::MatrixXd overlap = Eigen::MatrixXd::Zero(count, count);
  for (const NamedImages& named : images) {
    const auto found =
        std::find_if(trained.colors.begin(), trained.colors.end(),
                     [&](const TrainedColor& color) { return color.name == named.name; });
    if (found == trained.colors.end())
      throw InvalidInput("measure_overlap: colour " + named.name + " was never trained");
    for (const float hue : training_hues(named, options))
      overlap(found - trained.colors.begin(), classifier.best(hue)) += 1;
  }
  for (Eigen::Index i = 0; i < count; ++i) overlap.row(i) /= overlap.row(i).sum();
  return overlap;
}

Eigen::VectorXd hue_histogram(const NamedImages& images, int steps,
                              const TrainingOptions& options) {
  require("hue_histogram(): steps", steps, at_least(1));
  Eigen::VectorXd histogram = Eigen::VectorXd::Zero(steps);
  for (const float hue : training_hues(images, options)) {
    const double part = static_cast<double>(hue) / (2 * std::numbers::pi);
    histogram[std::clamp(static_cast<int>(part * steps), 0, steps - 1)] += 1;
  }
  return histogram;
}

std::vector<ConfusedColors> find_confused(const Eigen::MatrixXd& overlap, double limit) {
  std::vector<ConfusedColors> pairs;
  for (int i = 0; i < overlap.rows(); ++i) {
    for (int j = 0; j < overlap.cols(); ++j)
      if (i != j && overlap(i, j) > limit) pairs.push_back({i, j, overlap(i, j)});
  }
  std::stable_sort(pairs.begin(), pairs.end(),
                   [](const auto& a, const auto& b) { return a.probability > b.probability; });
  return pairs;
}

}  // namespace palpate::sensing
