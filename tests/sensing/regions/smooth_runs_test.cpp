// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/smooth_runs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <numbers>
#include <queue>
#include <random>
#include <tuple>
#include <vector>

#include "image/hue.h"

namespace palpate::sensing {
namespace {

constexpr double kMaxStep = 1.5;

struct Unwrapped {
  Labels label;
  Plane phase;
  int count = 0;
};

Unwrapped by_runs(const Plane& wrapped, const Mask& classes) {
  SmoothRuns runs;
  runs.find(Plane::Zero(3, 50), Mask::Zero(3, 50), kMaxStep);  // of another frame
  runs.find(wrapped, classes, kMaxStep);
  Unwrapped result;
  runs.write_labels(result.label);
  runs.write_phase(wrapped, result.phase);
  result.count = runs.count();
  return result;
}

/// Pixel after pixel with a heap: always on over the best link at the border (Prim).
Unwrapped by_heap(const Plane& wrapped, const Mask& classes) {
  Unwrapped result{Labels::Constant(wrapped.rows(), wrapped.cols(), -1), wrapped, 0};
  using Step = std::tuple<int, long, long, long>;  // class, number, from, to
  for (long seed = 0; seed < wrapped.size(); ++seed) {
    if (classes.data()[seed] == kNotSmooth || result.label.data()[seed] >= 0) continue;
    result.label.data()[seed] = result.count;
    std::priority_queue<Step, std::vector<Step>, std::greater<>> heap;
    long number = 0;
    const auto push = [&](long from) {
      const long column = from % wrapped.cols();
      const auto add = [&](long to) {
        if (classes.data()[to] == kNotSmooth) return;
        heap.emplace(std::max(classes.data()[from], classes.data()[to]), number++, from, to);
      };
      if (column > 0) add(from - 1);
      if (column + 1 < wrapped.cols()) add(from + 1);
      if (from >= wrapped.cols()) add(from - wrapped.cols());
      if (from + wrapped.cols() < wrapped.size()) add(from + wrapped.cols());
    };
    push(seed);
    while (!heap.empty()) {
      const auto [rank, order, from, to] = heap.top();
      heap.pop();
      if (result.label.data()[to] >= 0) continue;
      const float step = wrap(wrapped.data()[to] - wrapped.data()[from]);
      if (!(std::abs(static_cast<double>(step)) <= kMaxStep)) continue;
      result.label.data()[to] = result.count;
      result.phase.data()[to] = result.phase.data()[from] + step;
      push(to);
    }
    ++result.count;
  }
  return result;
}

/// The phases of two results differ by whole turns, the same in each region.
void expect_same_up_to_turns(const Unwrapped& a, const Unwrapped& b) {
  ASSERT_EQ(a.count, b.count);
  std::map<int, long> turns;
  for (long i = 0; i < a.label.size(); ++i) {
    ASSERT_EQ(a.label.data()[i], b.label.data()[i]) << i;
    if (a.label.data()[i] < 0) continue;
    const float difference =
        (a.phase.data()[i] - b.phase.data()[i]) / (2 * std::numbers::pi_v<float>);
    const long whole = std::lround(difference);
    EXPECT_NEAR(difference, static_cast<float>(whole), 1e-4) << i;
    EXPECT_EQ(turns.emplace(a.label.data()[i], whole).first->second, whole) << i;
  }
}

/// A bumpy surface many turns high, with gaps and rough patches.
struct Bumps {
  explicit Bumps(unsigned seed, long rows, long columns)
      : phase(rows, columns), classes(rows, columns) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> slope(-0.5, 0.5);
    const double down = slope(random);
    const double across = slope(random);
    std::discrete_distribution<int> kind({60, 10, 6, 4, 20});
    for (long row = 0; row < rows; ++row) {
      for (long column = 0; column < columns; ++column) {
        const auto r = static_cast<double>(row);
        const auto c = static_cast<double>(column);
        phase(row, column) =
            static_cast<float>(down * r + across * c + 4 * std::sin(r / 7) * std::cos(c / 9));
        const int drawn = kind(random);
        classes(row, column) = drawn == 4 ? kNotSmooth : static_cast<std::uint8_t>(drawn);
      }
    }
    wrapped = phase.unaryExpr([](float value) { return wrap(value); });
  }
  Plane phase;
  Plane wrapped;
  Mask classes;
};

TEST(SmoothRuns, GiveTheRegionsAndPhasesOfAFloodFromPixelToPixel) {
  int regions = 0;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const Bumps bumps(seed, 20 + seed, 61 - 2 * seed);
    const Unwrapped runs = by_runs(bumps.wrapped, bumps.classes);
    regions += runs.count;
    expect_same_up_to_turns(runs, by_heap(bumps.wrapped, bumps.classes));
    const Plane truth = bumps.phase;
    expect_same_up_to_turns(runs, {runs.label, truth, runs.count});
  }
  EXPECT_GT(regions, 40);
}

TEST(SmoothRuns, TransposingOrTurningTheImageChangesNothing) {
  const Bumps bumps(3, 40, 30);
  const Unwrapped upright = by_runs(bumps.wrapped, bumps.classes);
  const Unwrapped transposed = by_runs(bumps.wrapped.transpose(), bumps.classes.transpose());
  const Unwrapped turned = by_runs(bumps.wrapped.reverse(), bumps.classes.reverse());
  EXPECT_EQ(upright.count, transposed.count);
  EXPECT_EQ(upright.count, turned.count);
  const Plane a = upright.phase - transposed.phase.transpose();
  const Plane b = upright.phase - turned.phase.reverse();
  for (int region = 0; region < upright.count; ++region) {
    const auto inside = (upright.label == region).eval();
    for (const Plane& difference : {a, b}) {
      const float highest = inside.select(difference, -1e9F).maxCoeff();
      const float lowest = inside.select(difference, 1e9F).minCoeff();
      EXPECT_NEAR(highest, lowest, 1e-4) << region;
    }
  }
}

/// A ring whose phase gains a whole turn once round: somewhere it must break.
TEST(SmoothRuns, ALoopThatDoesNotCloseBreaksWhereItIsRoughest) {
  constexpr long kSize = 60;
  for (const double rough_at : {0.3, 1.7, 2.9, -2.2, -0.8}) {
    Plane wrapped(kSize, kSize);
    Mask classes(kSize, kSize);
    for (long row = 0; row < kSize; ++row) {
      for (long column = 0; column < kSize; ++column) {
        const double y = static_cast<double>(row) - kSize / 2.0;
        const double x = static_cast<double>(column) - kSize / 2.0;
        const double angle = std::atan2(y, x);
        const double radius = std::hypot(x, y);
        wrapped(row, column) = static_cast<float>(wrap(angle + 0.5));
        const bool ring = radius > 12 && radius < 27;
        const bool rough = std::abs(wrap(angle - rough_at)) < 0.15;
        classes(row, column) = !ring ? kNotSmooth : (rough ? 2 : 0);
      }
    }
    const Unwrapped result = by_runs(wrapped, classes);
    ASSERT_EQ(result.count, 1);
    int breaks = 0;
    for (long row = 0; row + 1 < kSize; ++row) {
      for (long column = 0; column + 1 < kSize; ++column) {
        for (const auto& [r, c] : {std::pair{row + 1, column}, {row, column + 1}}) {
          if (result.label(row, column) < 0 || result.label(r, c) < 0) continue;
          if (std::abs(result.phase(row, column) - result.phase(r, c)) < 2) continue;
          ++breaks;
          EXPECT_GT(std::max(classes(row, column), classes(r, c)), 0);
        }
      }
    }
    EXPECT_GT(breaks, 5);
  }
}

TEST(SmoothRuns, CountTheirPixelsAndTellTheFirst) {
  Mask classes = Mask::Constant(6, 9, kNotSmooth);
  classes.block(1, 4, 3, 2) = 1;
  classes.block(2, 0, 4, 3) = 0;
  SmoothRuns runs;
  runs.find(Plane::Zero(6, 9), classes, kMaxStep);
  std::vector<SmoothRuns::Extent> extents;
  runs.measure(extents);
  ASSERT_EQ(extents.size(), 2U);
  EXPECT_EQ(extents[0].first, 1 * 9 + 4);
  EXPECT_EQ(extents[0].pixels, 6);
  EXPECT_EQ(extents[1].first, 2 * 9);
  EXPECT_EQ(extents[1].pixels, 12);
}

TEST(SmoothRuns, AnUnknownPhaseLinksNothing) {
  Plane wrapped = Plane::Zero(3, 9);
  wrapped.col(4) = std::nanf("");
  const Unwrapped result = by_runs(wrapped, Mask::Zero(3, 9));
  EXPECT_NE(result.label(1, 3), result.label(1, 5));
  EXPECT_EQ(by_runs(Plane(0, 0), Mask(0, 0)).count, 0);
  EXPECT_EQ(by_runs(Plane::Zero(1, 1), Mask::Zero(1, 1)).count, 1);
}

}  // namespace
}  // namespace palpate::sensing
