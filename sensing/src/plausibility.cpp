// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "plausibility.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace palpate::sensing {
namespace {

/// A pixel is well inside a stripe iff it is this far from its edges [projector px]: farther than
/// the blur of camera and projector and the sideways shift of their colour channels.
constexpr double kEdgeMargin = 4;

/// "Nearby" is a square of this half width [px]: it holds more than one stripe.
constexpr long kNearby = 16;

/// Sums over rectangles in constant time.
class Integral {
 public:
  explicit Integral(const Mask& mask)
      : sums_(Eigen::ArrayXXi::Zero(mask.rows() + 1, mask.cols() + 1)) {
    for (long row = 0; row < mask.rows(); ++row) {
      int sum = 0;
      for (long column = 0; column < mask.cols(); ++column) {
        sum += mask(row, column);
        sums_(row + 1, column + 1) = sums_(row, column + 1) + sum;
      }
    }
  }
  /// Over the square of half width `half` around a pixel, cut at the image's border.
  [[nodiscard]] int around(long row, long column, long half) const {
    const long top = std::max<long>(0, row - half);
    const long left = std::max<long>(0, column - half);
    const long bottom = std::min<long>(sums_.rows() - 1, row + half + 1);
    const long right = std::min<long>(sums_.cols() - 1, column + half + 1);
    return sums_(bottom, right) - sums_(top, right) - sums_(bottom, left) + sums_(top, left);
  }

 private:
  Eigen::Array<int, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> sums_;
};

/// Colour index of the stripe at a projector pixel, or -1 near an edge.
int stripe_color(const Pattern& pattern, double pixel) {
  const auto& edges = pattern.stripe_edges;
  const auto next = std::upper_bound(edges.begin(), edges.end(), pixel);
  if (next != edges.end() && *next - pixel < kEdgeMargin) return -1;
  if (next != edges.begin() && pixel - *(next - 1) < kEdgeMargin) return -1;
  return pattern.stripes[static_cast<std::size_t>(next - edges.begin())];
}

}  // namespace

Mask eroded(const Mask& mask) {
  const Integral count(mask);
  Mask result = Mask::Zero(mask.rows(), mask.cols());
  for (long row = 0; row < mask.rows(); ++row) {
    const long high = std::min(row + 1, mask.rows() - 1) - std::max<long>(row - 1, 0) + 1;
    for (long column = 0; column < mask.cols(); ++column) {
      const long wide = std::min(column + 1, mask.cols() - 1) - std::max<long>(column - 1, 0) + 1;
      result(row, column) = count.around(row, column, 1) == high * wide ? 1 : 0;
    }
  }
  return result;
}

Mask near_breaks(const Plane& phase, const Mask& known, double max_step, const Reach& reach) {
  const long rows = phase.rows();
  const long columns = phase.cols();
  const auto limit = static_cast<float>(max_step);
  Mask marked = Mask::Zero(rows, columns);
  const auto mark = [&](long row, long column) {
    const long top = std::max<long>(0, row - reach.rows);
    const long left = std::max<long>(0, column - reach.columns);
    marked.block(top, left, std::min(rows - 1, row + reach.rows) - top + 1,
                 std::min(columns - 1, column + reach.columns) - left + 1) = 1;
  };
  for (long row = 0; row < rows; ++row) {
    for (long column = 0; column < columns; ++column) {
      if (known(row, column) == 0) continue;
      const auto breaks = [&](long other_row, long other_column) {
        return known(other_row, other_column) != 0 &&
               std::abs(phase(other_row, other_column) - phase(row, column)) > limit;
      };
      if ((column + 1 < columns && breaks(row, column + 1)) ||
          (row + 1 < rows && breaks(row + 1, column))) {
        mark(row, column);
      }
    }
  }
  return marked;
}

Mask contradicting_colors(const Plane& stripe_pixel, const Plane& hue, const Pattern& pattern,
                          const HueClassifier& classifier, double min_agreement) {
  Mask compared = Mask::Zero(hue.rows(), hue.cols());
  Mask agreeing = Mask::Zero(hue.rows(), hue.cols());
  for (long i = 0; i < hue.size(); ++i) {
    const float pixel = stripe_pixel.data()[i];
    if (!(pixel == pixel)) continue;
    const int color = stripe_color(pattern, static_cast<double>(pixel));
    if (color < 0) continue;
    compared.data()[i] = 1;
    agreeing.data()[i] = classifier.best(hue.data()[i]) == color ? 1 : 0;
  }
  const Integral all(compared);
  const Integral good(agreeing);
  Mask marked = Mask::Zero(hue.rows(), hue.cols());
  for (long row = 0; row < hue.rows(); ++row) {
    for (long column = 0; column < hue.cols(); ++column) {
      if (!(stripe_pixel(row, column) == stripe_pixel(row, column))) continue;
      marked(row, column) =
          good.around(row, column, kNearby) < min_agreement * all.around(row, column, kNearby) ? 1
                                                                                               : 0;
    }
  }
  return marked;
}

}  // namespace palpate::sensing
