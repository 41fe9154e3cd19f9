// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/plausibility.h"

#include <algorithm>
#include <cmath>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

PALPATE_HOT_LOOP void keep_common(std::uint8_t* values, const std::uint8_t* other, long count) {
  for (long i = 0; i < count; ++i) values[i] = values[i] & other[i];
}

/// Finds the pixels whose phase is discontinuous to the next one in the row, or to the one below;
/// returns true if there is any.
PALPATE_HOT_LOOP bool break_row(const float* phase, const float* below, float limit,
                                std::uint8_t* breaks, long columns) {
  int any = 0;
  for (long i = 0; i < columns; ++i) {
    const int right = std::abs(phase[i + 1] - phase[i]) > limit ? 1 : 0;
    const int down = std::abs(below[i] - phase[i]) > limit ? 1 : 0;
    breaks[i] = static_cast<std::uint8_t>(right | down);
    any |= right | down;
  }
  return any != 0;
}

/// Finds the pixels of a row with a phase that is not known to be near both the one to the left and
/// the one above.
PALPATE_HOT_LOOP void find_apart(const float* phase, const float* above, float limit,
                                 std::uint8_t* apart, long columns) {
  apart[0] = phase[0] == phase[0] ? 1 : 0;
  for (long i = 1; i < columns; ++i) {
    const bool near =
        (std::abs(phase[i] - phase[i - 1]) <= limit) & (std::abs(phase[i] - above[i]) <= limit);
    apart[i] = (phase[i] == phase[i]) & !near ? 1 : 0;
  }
}

void mark_around(long row, long column, const Reach& reach, Mask& marked) {
  const long top = std::max<long>(0, row - reach.rows);
  const long left = std::max<long>(0, column - reach.columns);
  marked.block(top, left, std::min(marked.rows() - 1, row + reach.rows) - top + 1,
               std::min(marked.cols() - 1, column + reach.columns) - left + 1) = 1;
}

PALPATE_HOT_LOOP void keep_larger(const float* values, float limit, long count,
                                  std::uint8_t* __restrict marked) {
  for (long i = 0; i < count; ++i) marked[i] = values[i] > limit ? marked[i] : 0;
}

/// Evidence of a pixel: `kCompared` if its colour is evidence, and `kAgreeing` if it confirms.
constexpr std::uint32_t kCompared = 1;
constexpr std::uint32_t kAgreeing = 1 << 16;

PALPATE_HOT_LOOP void look_up(const int* table, int* __restrict entries, long count) {
  for (long i = 0; i < count; ++i) entries[i] = table[entries[i]];
}

PALPATE_HOT_LOOP void find_entries(const float* stripe_pixel, const float* hue,
                                   const StripeColors& stripes, int* __restrict expected,
                                   int* __restrict seen, long columns) {
  for (long i = 0; i < columns; ++i) {
    expected[i] = stripes.entry(stripe_pixel[i]);
    seen[i] = HueClassifier::step_of(hue[i]);
  }
}

PALPATE_HOT_LOOP void say_row(const float* stripe_pixel, const int* expected, const int* seen,
                              std::uint8_t* __restrict says, long columns) {
  for (long i = 0; i < columns; ++i) {
    const bool known = (stripe_pixel[i] == stripe_pixel[i]) & (expected[i] >= 0);
    const int color = expected[i] + (seen[i] == expected[i] ? kConfirms : 0);
    says[i] = static_cast<std::uint8_t>(known ? color : kSilent);
  }
}

PALPATE_HOT_LOOP void count_row(const std::uint8_t* says, std::uint32_t* __restrict said,
                                long columns) {
  for (long i = 0; i < columns; ++i) {
    const std::uint32_t agreeing = (says[i] & kConfirms) != 0 ? kAgreeing : 0;
    said[i] = says[i] == kSilent ? 0 : kCompared + agreeing;
  }
}

PALPATE_HOT_LOOP void add_row(std::uint32_t* __restrict sums, const std::uint32_t* row,
                              long columns) {
  for (long i = 0; i < columns; ++i) sums[i] += row[i];
}

PALPATE_HOT_LOOP void take_row(std::uint32_t* __restrict sums, const std::uint32_t* row,
                               long columns) {
  for (long i = 0; i < columns; ++i) sums[i] -= row[i];
}

/// Marks the pixels in whose square too few agree.
/// \param until sums over all columns up to one, with the counts of both kinds in one number: it
/// may overflow, but differences over a square do not.
PALPATE_HOT_LOOP void judge_row(const std::uint32_t* until, const float* stripe_pixel,
                                float min_agreement, long width, std::uint8_t* __restrict marked,
                                long columns) {
  for (long i = 0; i < columns; ++i) {
    const std::uint32_t sum = until[i + width] - until[i];
    const auto all = static_cast<float>(static_cast<int>(sum % kAgreeing));
    const auto agreeing = static_cast<float>(static_cast<int>(sum / kAgreeing));
    const bool known = stripe_pixel[i] == stripe_pixel[i];
    marked[i] = known & (agreeing < min_agreement * all) ? 1 : 0;
  }
}

}  // namespace

void erode(const Mask& mask, int radius, Mask& inner) {
  const long rows = mask.rows();
  const long columns = mask.cols();
  inner = mask;
  // A row padded with `radius` pixels on either side, which do not erode.
  std::vector<std::uint8_t> wide(static_cast<std::size_t>(columns + 2 * radius), 1);
  for (long row = 0; row < rows; ++row) {
    std::uint8_t* const common = wide.data() + radius;
    std::copy_n(&mask(row, 0), columns, common);
    for (long other = std::max<long>(0, row - radius); other <= std::min(rows - 1, row + radius);
         ++other) {
      keep_common(common, &mask(other, 0), columns);
    }
    for (long k = 0; k <= 2 * radius; ++k) keep_common(&inner(row, 0), wide.data() + k, columns);
  }
}

void bridge_gaps(const Mask& mask, const Plane& phase, long width, double max_step, Mask& bridged) {
  bridged = mask;
  const auto limit = static_cast<float>(max_step);
  for (long row = 0; row < mask.rows(); ++row) {
    const std::uint8_t* const known = &mask(row, 0);
    long column = 1;
    while (column < mask.cols()) {
      if (known[column] != 0 || known[column - 1] == 0) {
        ++column;
        continue;
      }
      long end = column;
      while (end < mask.cols() && known[end] == 0) ++end;
      const bool continues = end < mask.cols() && end - column <= width &&
                             std::abs(phase(row, end) - phase(row, column - 1)) <= limit;
      if (continues) bridged.row(row).segment(column, end - column).setOnes();
      column = end + 1;
    }
  }
}

void find_breaks(const Plane& phase, double max_step, const Reach& reach, Mask& marked) {
  const long rows = phase.rows();
  const long columns = phase.cols();
  marked.setZero(rows, columns);
  const auto limit = static_cast<float>(max_step);
  std::vector<std::uint8_t> breaks(static_cast<std::size_t>(columns));
  for (long row = 0; row < rows; ++row) {
    const float* const here = &phase(row, 0);
    const float* const below = row + 1 < rows ? here + columns : here;
    // The last pixel of a row has no next one.
    const long last = columns - 1;
    const bool at_last = std::abs(below[last] - here[last]) > limit;
    if (at_last) mark_around(row, last, reach, marked);
    if (!break_row(here, below, limit, breaks.data(), last)) continue;
    for (long column = 0; column < last; ++column) {
      if (breaks[static_cast<std::size_t>(column)] != 0) mark_around(row, column, reach, marked);
    }
  }
}

void find_steps(const Plane& phase, const StepLimits& limits, const Reach& reach, Mask& marked) {
  const long columns = phase.cols();
  marked.setZero(phase.rows(), columns);
  const auto step = static_cast<float>(limits.step);
  const auto slope = static_cast<float>(limits.slope);
  std::vector<std::uint8_t> apart(static_cast<std::size_t>(columns));
  // Looks from a pixel for the next one with a phase, at most `gap` away.
  const auto look = [&](long row, long column, long down, long right, long gap) {
    for (long distance = 1; distance <= gap; ++distance) {
      const long other_row = row - distance * down;
      const long other_column = column - distance * right;
      if (other_row < 0 || other_column < 0) return;
      const float there = phase(other_row, other_column);
      if (std::isnan(there)) continue;
      const float difference = std::abs(phase(row, column) - there);
      if (difference > step + slope * static_cast<float>(distance)) {
        mark_around(other_row, other_column, reach, marked);
        mark_around(row, column, reach, marked);
      }
      return;
    }
  };
  for (long row = 0; row < phase.rows(); ++row) {
    const float* const here = &phase(row, 0);
    find_apart(here, row > 0 ? here - columns : here, step + slope, apart.data(), columns);
    for (long column = 0; column < columns; ++column) {
      if (apart[static_cast<std::size_t>(column)] == 0) continue;
      look(row, column, 0, 1, limits.gap.columns);
      look(row, column, 1, 0, limits.gap.rows);
    }
  }
}

void keep_above(const Plane& values, double limit, Mask& marked) {
  keep_larger(values.data(), static_cast<float>(limit), values.size(), marked.data());
}

StripeColors::StripeColors(const Pattern& pattern, double margin) {
  const auto& edges = pattern.stripe_edges;
  const double first = edges.front() - 2 * margin;
  const double last = edges.back() + 2 * margin;
  first_ = static_cast<float>(first);
  for (double pixel = first + 0.5 / kEntriesPerPixel; pixel < last;
       pixel += 1.0 / kEntriesPerPixel) {
    const auto next = std::upper_bound(edges.begin(), edges.end(), pixel);
    const bool near_next = next != edges.end() && *next - pixel < margin;
    const bool near_last = next != edges.begin() && pixel - *(next - 1) < margin;
    const auto stripe = static_cast<std::size_t>(next - edges.begin());
    table_.push_back(near_next || near_last ? -1 : static_cast<int>(pattern.stripes[stripe]));
  }
  last_ = static_cast<float>(table_.size() - 1);
}

void compare_colors(const Plane& stripe_pixel, const Plane& hue, const StripeColors& stripes,
                    const HueClassifier& classifier, ColorSays& says) {
  const long columns = hue.cols();
  says.resize(hue.rows(), columns);
  // For a row of pixels, first table entries, then colours: of the stripe there, and of the hue.
  std::vector<int> expected(static_cast<std::size_t>(columns));
  std::vector<int> seen(expected.size());
  for (long row = 0; row < hue.rows(); ++row) {
    find_entries(&stripe_pixel(row, 0), &hue(row, 0), stripes, expected.data(), seen.data(),
                 columns);
    look_up(stripes.color_of_entries(), expected.data(), columns);
    look_up(classifier.best_of_steps(), seen.data(), columns);
    say_row(&stripe_pixel(row, 0), expected.data(), seen.data(), &says(row, 0), columns);
  }
}

void find_contradictions(const Plane& stripe_pixel, const ColorSays& says, double min_agreement,
                         long nearby, Mask& marked) {
  const long rows = says.rows();
  const long columns = says.cols();
  marked.resize(rows, columns);
  // Evidence of the rows nearby, row by row in a ring buffer; its sum over these rows; and the
  // prefix sums of that over the columns, padded with `nearby` empty columns on either side.
  using Numbers = Eigen::Array<std::uint32_t, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
  const long width = 2 * nearby + 1;
  Numbers said = Numbers::Zero(width, columns);
  Numbers sums = Numbers::Zero(1, columns);
  Numbers until = Numbers::Zero(1, columns + width);
  for (long row = -nearby; row < rows; ++row) {
    const long entering = row + nearby;
    std::uint32_t* const place = &said(entering % width, 0);
    take_row(sums.data(), place, columns);
    if (entering < rows) {
      count_row(&says(entering, 0), place, columns);
      add_row(sums.data(), place, columns);
    } else {
      std::fill_n(place, columns, 0U);
    }
    if (row < 0) continue;
    std::uint32_t sum = 0;
    for (long column = 0; column < columns; ++column) {
      until(0, column + nearby) = sum;
      sum += sums(0, column);
    }
    until.rightCols(nearby + 1) = sum;
    judge_row(until.data(), &stripe_pixel(row, 0), static_cast<float>(min_agreement), width,
              &marked(row, 0), columns);
  }
}

}  // namespace palpate::sensing
