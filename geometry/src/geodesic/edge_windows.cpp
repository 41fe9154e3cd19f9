// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "geodesic/edge_windows.h"

#include <algorithm>

#include "base/numbers.h"

namespace palpate::geometry {
namespace {

/// A window replaces another one iff it is nearer by more than this fraction of the distance: above
/// the rounding by which two ways to compute the same path differ.
constexpr double kNearer = 1e-13;

/// Used instead of the index of a known window.
constexpr int kAdded = -1;

/// Difference of two distances along an edge, negative where `added` is the nearer one. It is
/// monotone on either side of one place at most.
struct Difference {
  const Window& known;
  const Window& added;

  [[nodiscard]] double at(double place) const { return added.at(place) - known.at(place); }

  /// The place at which the lines from both points are parallel.
  [[nodiscard]] double extremum() const {
    return (added.along * known.height - known.along * added.height) /
           (known.height - added.height);
  }

  /// The place where it is zero, between two places where its signs differ (regula falsi in the
  /// Illinois variant).
  [[nodiscard]] double zero(double low, double at_low, double high, double at_high) const {
    constexpr int kMostSteps = 60;
    const double enough = 0.1 * kNearer * known.at(low);
    int moved = 0;  // which end was moved last
    for (int i = 0; i < kMostSteps; ++i) {
      const double place = (low * at_high - high * at_low) / (at_high - at_low);
      if (!(place > low && place < high)) return std::clamp(place, low, high);
      const double value = at(place);
      if (std::abs(value) <= enough) return place;
      if ((value < 0) == (at_high < 0)) {
        high = place;
        at_high = value;
        if (moved == 1) at_low /= 2;
        moved = 1;
      } else {
        low = place;
        at_low = value;
        if (moved == -1) at_high /= 2;
        moved = -1;
      }
    }
    return (low + high) / 2;
  }
};

}  // namespace

/// Appends a part of a window, or extends the last part if it is of the same window.
void EdgeWindows::append(const Window& window, double begin, double end, int index) {
  if (!(begin < end)) return;
  if (index == kAdded) is_added_ = true;
  if (!parts_.empty() && last_ == index && parts_.back().end == begin) {
    parts_.back().end = end;
    return;
  }
  parts_.push_back(window);
  parts_.back().begin = begin;
  parts_.back().end = end;
  last_ = index;
}

void EdgeWindows::append_nearer(const Window& known, int index, const Window& added, double begin,
                                double end) {
  const Difference difference{known, added};
  const double enough = -kNearer * known.at(begin);
  const auto append_between = [&](double low, double at_low, double high, double at_high) {
    const bool before = at_low < enough;
    const bool after = at_high < enough;
    double place = high;
    if (before != after && (at_low < 0) != (at_high < 0)) {
      place = difference.zero(low, at_low, high, at_high);
    }
    const auto append_winner = [&](bool is_nearer, double from, double to) {
      append(is_nearer ? added : known, from, to, is_nearer ? kAdded : index);
    };
    if (before == after || place < high) {
      append_winner(before, low, place);
      append_winner(after, place, high);
    } else {
      append_winner(true, low, high);
    }
  };
  const double at_begin = difference.at(begin);
  const double at_end = difference.at(end);
  const double turn = difference.extremum();
  if ((at_begin < enough) == (at_end < enough) && turn > begin && turn < end) {
    const double at_turn = difference.at(turn);
    append_between(begin, at_begin, turn, at_turn);
    append_between(turn, at_turn, end, at_end);
  } else {
    append_between(begin, at_begin, end, at_end);
  }
}

double EdgeWindows::add(int edge, const Window& window) {
  std::vector<Window>& windows = of(edge);
  const auto first = std::find_if(windows.begin(), windows.end(),
                                  [&](const Window& known) { return known.end > window.begin; });
  auto last = first;
  parts_.clear();
  is_added_ = false;
  double from = window.begin;
  for (; last != windows.end() && last->begin < window.end; ++last) {
    const auto index = static_cast<int>(last - windows.begin());
    const double begin = std::max(last->begin, window.begin);
    const double end = std::min(last->end, window.end);
    append(window, from, begin, kAdded);
    append(*last, last->begin, begin, index);
    append_nearer(*last, index, window, begin, end);
    append(*last, end, last->end, index);
    from = end;
  }
  append(window, from, window.end, kAdded);
  if (!is_added_) return kInfinity;
  double least = kInfinity;
  for (const Window& part : parts_) {
    if (part.waits && part.forward == window.forward) least = std::min(least, part.least());
  }
  const auto replaced = std::min(static_cast<std::ptrdiff_t>(parts_.size()), last - first);
  const auto rest = std::copy_n(parts_.begin(), replaced, first);
  if (rest != last) {
    windows.erase(rest, last);
  } else {
    windows.insert(rest, parts_.begin() + replaced, parts_.end());
  }
  return least;
}

void EdgeWindows::finish(int edge, bool keep) {
  if (!keep) of(edge).clear();
  of(edge).shrink_to_fit();
  finished_[static_cast<size_t>(edge)] = 1;
}

}  // namespace palpate::geometry
