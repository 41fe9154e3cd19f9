// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/phase_seams.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "image/hot_loop.h"
#include "image/hue.h"
#include "palpate/core/quantile.h"

namespace palpate::sensing {
namespace {

/// Number of pixels on each side of a seam over which slopes are measured.
constexpr int kSlopePixels = 4;

/// Slopes on both sides may differ by this times the width of the seam [turns], because the phase
/// is curved.
constexpr double kMaxBend = 0.08;

/// A crossing of the border gives a whole number of turns if it is this close to it [turns] ...
constexpr double kNearCrossingTurns = 0.08;

/// ... and all crossings that agree on the number do if their mean is this close.
constexpr double kMeanTurns = 0.03;

/// Smallest number of crossings of a border, counting rows and columns.
constexpr std::size_t kLeastCrossings = 20;

/// A point at which a line of pixels leaves a region and enters another one beyond a seam.
struct Crossing {
  int from = 0;      ///< region
  int to = 0;        ///< region
  double turns = 0;  ///< to be added to the phase of `from` to continue that of `to`
};

/// A line of `length` pixels, `stride` apart.
class PixelLine {
 public:
  PixelLine(const int* label, const float* phase, long stride, int length)
      : label_(label), phase_(phase), stride_(stride), length_(length) {}

  /// The turns from the region of pixel `a` to that of pixel `b`, if the seam between them is even.
  [[nodiscard]] std::optional<double> turns_between(int a, int b) const {
    const auto left = slope(a, a - kSlopePixels);
    const auto right = slope(b, b + kSlopePixels);
    if (!left || !right) return std::nullopt;
    if (std::abs(*left - *right) * (b - a) > kMaxBend * kFullTurn) return std::nullopt;
    return (phase(b) - phase(a) - (*left + *right) / 2 * (b - a)) / kFullTurn;
  }

 private:
  [[nodiscard]] int label(int i) const { return label_[i * stride_]; }
  [[nodiscard]] double phase(int i) const { return static_cast<double>(phase_[i * stride_]); }

  /// Slope at `i`, from there to `far`, if all pixels in between belong to one region [rad/px].
  [[nodiscard]] std::optional<double> slope(int i, int far) const {
    if (far < 0 || far >= length_) return std::nullopt;
    for (int k = std::min(i, far); k <= std::max(i, far); ++k) {
      if (label(k) != label(i)) return std::nullopt;
    }
    return (phase(far) - phase(i)) / (far - i);
  }

  const int* label_;
  const float* phase_;
  long stride_;
  int length_;
};

/// Finds the pixels of a row in a region other than that of the pixel to the left or the one above.
PALPATE_HOT_LOOP void find_entered(const int* label, const int* above, std::uint8_t* entered,
                                   long columns) {
  entered[0] = label[0] >= 0 ? 1 : 0;
  for (long i = 1; i < columns; ++i) {
    const bool other = (label[i] != label[i - 1]) | (label[i] != above[i]);
    entered[i] = (label[i] >= 0) & other ? 1 : 0;
  }
}

std::vector<Crossing> find_crossings(const Regions& regions, const SeamLimits& limits,
                                     const std::vector<RegionOffset>& offsets) {
  std::vector<Crossing> crossings;
  const auto unsolved = [&](int label) { return !offsets[static_cast<std::size_t>(label)].phase; };
  const auto wanted = [&](int a, int b) { return unsolved(a) || unsolved(b); };
  const auto add = [&](const Crossing& crossing) {
    if (unsolved(crossing.from)) crossings.push_back(crossing);
    if (unsolved(crossing.to)) {
      crossings.push_back({crossing.to, crossing.from, -crossing.turns});
    }
  };
  const int rows = static_cast<int>(regions.label.rows());
  const int columns = static_cast<int>(regions.label.cols());
  // Looks from a pixel back along a line for the next one in a region.
  const auto look = [&](const int* label, const PixelLine& line, long stride, int at) {
    for (int other = at - 1; other >= 0 && at - other - 1 <= limits.max_width; --other) {
      const int before = label[other * stride];
      if (before < 0) continue;
      const int here = label[at * stride];
      if (before == here || at - other - 1 < limits.min_width || !wanted(before, here)) return;
      if (const auto turns = line.turns_between(other, at)) add({before, here, *turns});
      return;
    }
  };
  std::vector<std::uint8_t> entered(static_cast<std::size_t>(columns));
  for (int row = 0; row < rows; ++row) {
    const int* const label = &regions.label(row, 0);
    find_entered(label, row > 0 ? label - columns : label, entered.data(), columns);
    const PixelLine along(label, &regions.phase(row, 0), 1, columns);
    for (int column = 0; column < columns; ++column) {
      if (entered[static_cast<std::size_t>(column)] == 0) continue;
      look(label, along, 1, column);
      const int* const top = regions.label.data() + column;
      look(top, PixelLine(top, regions.phase.data() + column, columns, rows), columns, row);
    }
  }
  std::stable_sort(crossings.begin(), crossings.end(),
                   [](const Crossing& a, const Crossing& b) { return a.from < b.from; });
  return crossings;
}

/// Result of the crossings from one region to solved ones; empty if there are too few.
std::optional<RegionOffset> judge(const std::vector<double>& turns, double min_agreement) {
  if (turns.size() < kLeastCrossings) return std::nullopt;
  const double whole = std::round(median(turns));
  double agreeing = 0;
  double elsewhere = 0;
  double lean = 0;
  for (const double value : turns) {
    if (std::abs(value - whole) <= kNearCrossingTurns) {
      ++agreeing;
      lean += value - whole;
    } else if (std::abs(value - std::round(value)) <= kNearCrossingTurns) {
      ++elsewhere;
    }
  }
  const auto all = static_cast<double>(turns.size());
  const bool even = agreeing > 0 && std::abs(lean / agreeing) <= kMeanTurns;
  if (agreeing >= min_agreement * all && even) {
    return RegionOffset{kFullTurn * whole, Reason::reconstructed};
  }
  if (elsewhere > (1 - min_agreement) * all) return RegionOffset{{}, Reason::ambiguous_offset};
  return std::nullopt;
}

}  // namespace

void solve_from_neighbours(const Regions& regions, const SeamLimits& limits,
                           std::vector<RegionOffset>& offsets) {
  const auto open = [](const RegionOffset& offset) {
    return !offset.phase && offset.reason == Reason::no_transition;
  };
  if (std::none_of(offsets.begin(), offsets.end(), open)) return;
  const std::vector<Crossing> crossings = find_crossings(regions, limits, offsets);
  std::vector<double> turns;
  // Each round solves the regions that follow from those solved in the rounds before.
  for (bool solved = true; solved;) {
    solved = false;
    const std::vector<RegionOffset> before = offsets;
    for (auto first = crossings.begin(); first != crossings.end();) {
      const auto region = static_cast<std::size_t>(first->from);
      const auto end = std::find_if(first, crossings.end(), [&](const Crossing& crossing) {
        return crossing.from != first->from;
      });
      if (open(before[region])) {
        turns.clear();
        for (auto crossing = first; crossing != end; ++crossing) {
          const RegionOffset& beyond = before[static_cast<std::size_t>(crossing->to)];
          if (beyond.phase) turns.push_back(crossing->turns + *beyond.phase / kFullTurn);
        }
        if (const auto judged = judge(turns, limits.min_agreement)) {
          offsets[region] = *judged;
          solved = true;
        }
      }
      first = end;
    }
  }
}

}  // namespace palpate::sensing
