// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/region_samples.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "image/hue.h"

namespace palpate::sensing {
namespace {

/// Number of pixels of a group that are sampled, about, and smallest spacing [px].
constexpr double kGroupSamples = 3000;
constexpr int kLeastSampleSpacing = 2;
/// Distance beyond the end of a run to which its phase is continued [px]: less than half a stripe.
constexpr int kBeyondRun = 8;

class RowSampler {
 public:
  RowSampler(const Regions& regions, const JoinedRegions& joined, int group, int row, int spacing,
             int max_gap, std::vector<RegionSample>& samples)
      : regions_(&regions),
        joined_(&joined),
        samples_(&samples),
        label_(&regions.label(row, 0)),
        columns_(static_cast<int>(regions.label.cols())),
        group_(group),
        row_(row),
        spacing_(spacing),
        max_gap_(max_gap) {}

  void add_row() {
    for (int first = 0; first < columns_;) {
      if (!has(first)) {
        ++first;
        continue;
      }
      int last = first;
      while (last + 1 < columns_ && label_[last + 1] == label_[first]) ++last;
      for (int column = first; column <= last; column += spacing_) {
        const auto phase = static_cast<double>(regions_->phase(row_, column));
        samples_->push_back({row_, column, phase + offset(column), label_[first]});
      }
      const int next = beyond(last, 1);
      if (has(next)) {
        interpolate(last, next);
      } else {
        extrapolate(last, 1, next);
      }
      // A gap between two of the group's runs is added from its left end.
      const int before = beyond(first, -1);
      if (!has(before)) extrapolate(first, -1, before);
      first = last + 1;
    }
  }

 private:
  [[nodiscard]] bool has(int column) const {
    return column >= 0 && column < columns_ && label_[column] >= 0 &&
           joined_->group[static_cast<std::size_t>(label_[column])] == group_;
  }
  [[nodiscard]] double offset(int column) const {
    return kFullTurn * joined_->turns[static_cast<std::size_t>(label_[column])];
  }
  /// The first column beyond a run's end that is in a region, too far away, or outside the image.
  [[nodiscard]] int beyond(int end, int direction) const {
    int column = end + direction;
    while (column >= 0 && column < columns_ && label_[column] < 0 &&
           std::abs(column - end) <= max_gap_) {
      column += direction;
    }
    return column;
  }
  void interpolate(int left, int right) {
    const auto from = phase_end(*regions_, row_, left, -1);
    const auto to = phase_end(*regions_, row_, right, 1);
    if (!from || !to) return;
    const double first = from->phase + offset(left);
    const double slope = (to->phase + offset(right) - first) / (right - left);
    for (int column = left + 1; column < right; column += spacing_) {
      samples_->push_back({row_, column, first + slope * (column - left)});
    }
  }
  void extrapolate(int end, int direction, int until) {
    const auto from = phase_end(*regions_, row_, end, -direction);
    if (!from) return;
    const int reach = std::min(kBeyondRun + 1, std::abs(until - end));
    for (int i = 1; i < reach; i += spacing_) {
      const int column = end + direction * i;
      samples_->push_back({row_, column, from->phase + offset(end) + from->slope * (column - end)});
    }
  }

  const Regions* regions_;
  const JoinedRegions* joined_;
  std::vector<RegionSample>* samples_;
  const int* label_;  ///< of the row
  int columns_;
  int group_;
  int row_;
  int spacing_;
  int max_gap_;
};

}  // namespace

std::vector<RegionGroup> region_groups(const Regions& regions, const JoinedRegions& joined) {
  std::vector<RegionGroup> groups(static_cast<std::size_t>(joined.count));
  for (std::size_t i = 0; i < groups.size(); ++i) {
    groups[i].number = static_cast<int>(i);
    groups[i].top = std::numeric_limits<long>::max();
  }
  for (long row = 0; row < regions.label.rows(); ++row) {
    for (long column = 0; column < regions.label.cols(); ++column) {
      const int label = regions.label(row, column);
      const int number = label < 0 ? -1 : joined.group[static_cast<std::size_t>(label)];
      if (number < 0) continue;
      RegionGroup& group = groups[static_cast<std::size_t>(number)];
      ++group.pixels;
      group.top = std::min(group.top, row);
      group.bottom = row;
    }
  }
  return groups;
}

std::vector<RegionSample> sample_group(const Regions& regions, const JoinedRegions& joined,
                                       const RegionGroup& group, int max_gap) {
  const double spacing = std::sqrt(static_cast<double>(group.pixels) / kGroupSamples);
  const int step = std::max(kLeastSampleSpacing, static_cast<int>(std::lround(spacing)));
  std::vector<RegionSample> samples;
  for (long row = group.top; row <= group.bottom; row += step) {
    RowSampler(regions, joined, group.number, static_cast<int>(row), step, max_gap, samples)
        .add_row();
  }
  return samples;
}

}  // namespace palpate::sensing
