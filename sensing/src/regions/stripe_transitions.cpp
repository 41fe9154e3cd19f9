// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/stripe_transitions.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// Smallest length of a window that classifies a colour [px].
constexpr int kLeastWindow = 3;

struct WindowColor {
  int color = 0;
  float score = 0;  ///< mean probability, in [0, 1]
};

/// The most probable colour of a window (Eqs. 3.3 and 3.5).
WindowColor window_color(const float* hues, int length, const HueClassifier& classifier) {
  using Group = Eigen::Array<float, HueClassifier::kGroup, 1>;
  WindowColor best;
  float largest = -1;
  for (int first = 0; first < classifier.padded_colors(); first += HueClassifier::kGroup) {
    Group sums = Group::Zero();
    for (int i = 0; i < length; ++i) {
      sums += Eigen::Map<const Group>(classifier.probabilities(hues[i]) + first);
    }
    int color = 0;
    const float sum =
        sums.head(std::min(HueClassifier::kGroup, classifier.colors() - first)).maxCoeff(&color);
    if (sum > largest) {
      largest = sum;
      best.color = first + color;
    }
  }
  best.score = largest / static_cast<float>(length);
  return best;
}

/// Change of the hue from each column to the next; 0 next to unlit pixels.
PALPATE_HOT_LOOP void find_steps(const float* hues, const std::uint8_t* lit, float* steps,
                                 long count) {
  constexpr float kHalf = std::numbers::pi_v<float>;
  PALPATE_INDEPENDENT_PASSES
  for (long i = 0; i < count; ++i) {
    const float step = std::abs(hues[i + 1] - hues[i]);  // both in [0, 2 pi)
    const float shorter = step > kHalf ? 2 * kHalf - step : step;
    steps[i] = (lit[i] & lit[i + 1]) != 0 ? shorter : 0;
  }
}

class Scanline {
 public:
  /// \param steps buffer with one number per column.
  Scanline(const Plane& hue, const Mask& lit, int row, double min_step, std::vector<float>& steps)
      : hues_(&hue(row, 0)),
        lit_(&lit(row, 0)),
        steps_(steps.data()),
        columns_(static_cast<int>(hue.cols())),
        min_step_(static_cast<float>(min_step)) {
    find_steps(hues_, lit_, steps.data(), columns_ - 1);
  }

  /// The next group of fast changes at or after `column`: from its first pixel to the pixel after
  /// its last change. Returns an empty group at the end.
  [[nodiscard]] std::pair<int, int> next_group(int column) const {
    while (column + 1 < columns_ && steps_[column] < min_step_) ++column;
    int last = column;
    while (last + 1 < columns_ && steps_[last] >= min_step_) ++last;
    return {column, last};
  }
  /// Position of the hue change between the two: the mean of the pixels weighted by their change.
  [[nodiscard]] float center(int first, int last) const {
    float total = 0;
    float moment = 0;
    for (int column = first; column < last; ++column) {
      total += steps_[column];
      moment += steps_[column] * (static_cast<float>(column) + 0.5F);
    }
    return moment / total;
  }
  /// Number of pixels from `column` on in `direction` that are lit and of one hue, up to `most`.
  [[nodiscard]] int run(int column, int direction, int most) const {
    int length = 0;
    while (length < most && column >= 0 && column < columns_ && lit_[column] != 0) {
      ++length;
      const int next = column + direction;
      if (next < 0 || next >= columns_ || steps_[std::min(column, next)] >= min_step_) break;
      column = next;
    }
    return length;
  }
  [[nodiscard]] const float* hues() const { return hues_; }

 private:
  const float* hues_;
  const std::uint8_t* lit_;
  const float* steps_;
  int columns_;
  float min_step_;
};

}  // namespace

StripeEdges::StripeEdges(const Pattern& pattern)
    : colors_(pattern.colors.size()), edges_(colors_ * colors_, -1) {
  for (std::size_t i = 0; i + 1 < pattern.stripes.size(); ++i) {
    const auto left = static_cast<std::size_t>(pattern.stripes[i]);
    const auto right = static_cast<std::size_t>(pattern.stripes[i + 1]);
    edges_[left * colors_ + right] = static_cast<int>(i);
  }
}

void find_transitions(const Plane& hue, const Mask& lit, const StripeEdges& edges,
                      const HueClassifier& classifier, const TransitionOptions& options,
                      std::vector<Transition>& transitions) {
  const auto min_score = static_cast<float>(options.min_color_score);
  std::vector<float> steps(static_cast<std::size_t>(hue.cols()));
  transitions.clear();
  for (int row = 0; row < hue.rows(); ++row) {
    const Scanline line(hue, lit, row, options.min_hue_step, steps);
    for (auto [first, last] = line.next_group(0); last > first;
         std::tie(first, last) = line.next_group(last)) {
      const int window =
          std::min(line.run(first, -1, options.window_px), line.run(last, 1, options.window_px));
      if (window < std::min(kLeastWindow, options.window_px)) continue;
      WindowColor left = window_color(line.hues() + first - window + 1, window, classifier);
      WindowColor right = window_color(line.hues() + last, window, classifier);
      if (left.score < min_score || right.score < min_score) continue;
      if (options.reversed) std::swap(left, right);
      const int edge = edges.find(left.color, right.color);
      if (edge < 0) continue;
      transitions.push_back({row, line.center(first, last), edge, left.score + right.score});
    }
  }
}

}  // namespace palpate::sensing
