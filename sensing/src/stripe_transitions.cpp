// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "stripe_transitions.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "hue.h"

namespace palpate::sensing {
namespace {

/// For each ordered pair of colours the edge of the pattern between them, or -1.
class EdgeTable {
 public:
  explicit EdgeTable(const Pattern& pattern)
      : colors_(pattern.colors.size()), edges_(colors_ * colors_, -1) {
    for (std::size_t i = 0; i + 1 < pattern.stripes.size(); ++i) {
      const auto left = static_cast<std::size_t>(pattern.stripes[i]);
      const auto right = static_cast<std::size_t>(pattern.stripes[i + 1]);
      edges_[left * colors_ + right] = static_cast<int>(i);
    }
  }
  [[nodiscard]] int find(int left, int right) const {
    return edges_[static_cast<std::size_t>(left) * colors_ + static_cast<std::size_t>(right)];
  }

 private:
  std::size_t colors_;
  std::vector<int> edges_;
};

/// Shorter windows say too little of a colour [px].
constexpr int kLeastWindow = 3;

struct WindowColor {
  int color = 0;
  float score = 0;  ///< mean probability, in [0, 1]
};

/// The most probable colour of a window (Eqs. 3.3 and 3.5).
WindowColor window_color(const float* hues, int length, const HueClassifier& classifier) {
  std::vector<float> sums(static_cast<std::size_t>(classifier.colors()), 0.0F);
  for (int i = 0; i < length; ++i) {
    const float* probabilities = classifier.probabilities(hues[i]);
    for (std::size_t c = 0; c < sums.size(); ++c) sums[c] += probabilities[c];
  }
  const auto best = std::max_element(sums.begin(), sums.end());
  return {static_cast<int>(best - sums.begin()), *best / static_cast<float>(length)};
}

class Scanline {
 public:
  Scanline(const Plane& hue, const Mask& lit, int row, double min_step)
      : hues_(&hue(row, 0)),
        lit_(&lit(row, 0)),
        columns_(static_cast<int>(hue.cols())),
        min_step_(static_cast<float>(min_step)) {}

  /// Change of the hue from a column to the next; 0 next to unlit pixels.
  [[nodiscard]] float step(int column) const {
    if (lit_[column] == 0 || lit_[column + 1] == 0) return 0;
    return std::abs(wrap(hues_[column + 1] - hues_[column]));
  }
  /// The next group of fast changes at or after `column`: from its first pixel to the pixel after
  /// its last change. An empty group at the end.
  [[nodiscard]] std::pair<int, int> next_group(int column) const {
    while (column + 1 < columns_ && step(column) < min_step_) ++column;
    int last = column;
    while (last + 1 < columns_ && step(last) >= min_step_) ++last;
    return {column, last};
  }
  /// Where between the two the hue changes, each pixel weighted with its change.
  [[nodiscard]] float center(int first, int last) const {
    float total = 0;
    float moment = 0;
    for (int column = first; column < last; ++column) {
      total += step(column);
      moment += step(column) * (static_cast<float>(column) + 0.5F);
    }
    return moment / total;
  }
  /// How many pixels from `column` on, going by `direction`, are lit and of one hue, up to `most`.
  [[nodiscard]] int run(int column, int direction, int most) const {
    int length = 0;
    while (length < most && column >= 0 && column < columns_ && lit_[column] != 0) {
      ++length;
      const int next = column + direction;
      if (next < 0 || next >= columns_ || step(std::min(column, next)) >= min_step_) break;
      column = next;
    }
    return length;
  }
  [[nodiscard]] const float* hues() const { return hues_; }

 private:
  const float* hues_;
  const std::uint8_t* lit_;
  int columns_;
  float min_step_;
};

}  // namespace

std::vector<Transition> find_transitions(const Plane& hue, const Mask& lit, const Pattern& pattern,
                                         const HueClassifier& classifier,
                                         const TransitionOptions& options) {
  const EdgeTable edges(pattern);

  const auto min_score = static_cast<float>(options.min_color_score);
  std::vector<Transition> result;
  for (int row = 0; row < hue.rows(); ++row) {
    const Scanline line(hue, lit, row, options.min_hue_step);
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
      result.push_back({row, line.center(first, last), edge, left.score + right.score});
    }
  }
  return result;
}

}  // namespace palpate::sensing
