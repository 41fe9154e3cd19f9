// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/unwrapping.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// Half the width of the necks that are cut [px].
constexpr long kNeck = 3;
/// Smallest core in which a marker is expected [px]; a smaller one may lie between two stripe
/// edges.
constexpr int kLeastCore = 300;

/// Smoothness classes have equal width in the square root of the variance.
PALPATE_HOT_LOOP void classify(const float* variance, float max_variance, std::uint8_t* classes,
                               long pixels) {
  const float per_class = max_variance / (kSmoothClasses * kSmoothClasses);
  for (long i = 0; i < pixels; ++i) {
    const float value = variance[i];
    int rank = 0;
    for (int k = 1; k < kSmoothClasses; ++k) {
      rank += value > per_class * static_cast<float>(k * k) ? 1 : 0;
    }
    classes[i] = value <= max_variance ? static_cast<std::uint8_t>(rank) : kNotSmooth;
  }
}

/// Pixels in no region are in no core either, whatever the limits.
PALPATE_HOT_LOOP void leave_out(const int* label, std::uint8_t* classes, long pixels) {
  for (long i = 0; i < pixels; ++i) classes[i] = label[i] < 0 ? kNotSmooth : classes[i];
}

PALPATE_HOT_LOOP void raise_to(const std::uint8_t* other, std::uint8_t* values, long count) {
  for (long i = 0; i < count; ++i) values[i] = values[i] > other[i] ? values[i] : other[i];
}

PALPATE_HOT_LOOP void keep_cores(std::uint8_t* classes, long count) {
  for (long i = 0; i < count; ++i) classes[i] = classes[i] == kNotSmooth ? kNotSmooth : 0;
}

/// Erodes the smooth pixels by kNeck; the remaining ones have one class. The image's border does
/// not erode.
void cut_necks(Mask& classes, Mask& row_minima) {
  const long rows = classes.rows();
  const long columns = classes.cols();
  row_minima = classes;
  for (long row = 0; row < rows; ++row) {
    for (long shift = 1; shift <= std::min(kNeck, columns - 1); ++shift) {
      raise_to(&classes(row, shift), &row_minima(row, 0), columns - shift);
      raise_to(&classes(row, 0), &row_minima(row, shift), columns - shift);
    }
  }
  classes = row_minima;
  for (long shift = 1; shift <= std::min(kNeck, rows - 1); ++shift) {
    const long count = (rows - shift) * columns;
    raise_to(&row_minima(shift, 0), classes.data(), count);
    raise_to(row_minima.data(), &classes(shift, 0), count);
  }
  keep_cores(classes.data(), classes.size());
}

/// The parts of the regions and their labels; the first part of a region keeps its label.
class Parts {
 public:
  explicit Parts(Regions& regions)
      : regions_(&regions), of_region_(static_cast<std::size_t>(regions.count)) {}

  /// The part of a region with this number of turns; created if it does not exist.
  int with_turns(int region, int turns) {
    auto& parts = of_region_[static_cast<std::size_t>(region)];
    for (const auto& [known, label] : parts) {
      if (known == turns) return label;
    }
    parts.emplace_back(turns, new_label(region));
    return parts.back().second;
  }
  int of_unknown_turns(int region) {
    auto& parts = of_region_[static_cast<std::size_t>(region)];
    parts.emplace_back(kUnknownTurns, new_label(region));
    return parts.back().second;
  }
  /// For label -1 and then for each region whether it has several parts.
  [[nodiscard]] std::vector<int> several() const {
    std::vector<int> result(1, 0);
    for (const auto& parts : of_region_) result.push_back(parts.size() > 1 ? 1 : 0);
    return result;
  }
  [[nodiscard]] bool any_several() const {
    return std::any_of(of_region_.begin(), of_region_.end(),
                       [](const auto& parts) { return parts.size() > 1; });
  }

 private:
  static constexpr int kUnknownTurns = std::numeric_limits<int>::max();
  int new_label(int region) {
    return of_region_[static_cast<std::size_t>(region)].empty() ? region : regions_->count++;
  }
  Regions* regions_;
  std::vector<std::vector<std::pair<int, int>>> of_region_;
};

/// Part of a core: a label, or one of these.
constexpr int kNoMarker = -1;
constexpr int kDisagreeing = -2;

/// The part of each core, from its markers.
void vote_cores(const Labels& label, const std::vector<Marker>& markers, const Labels& core,
                Parts& parts, std::vector<int>& core_parts) {
  for (const Marker& marker : markers) {
    if (label.data()[marker.pixel] < 0) continue;
    const int part = parts.with_turns(label.data()[marker.pixel], marker.turns);
    const int of_core = core.data()[marker.pixel];
    if (of_core < 0) continue;
    int& known = core_parts[static_cast<std::size_t>(of_core)];
    if (known == kNoMarker) known = part;
    if (known != part) known = kDisagreeing;
  }
}

/// Large cores without any marker become parts of their own.
void doubt_cores(const Labels& label, const std::vector<SmoothRuns::Extent>& cores, Parts& parts,
                 std::vector<int>& core_parts) {
  for (std::size_t i = 0; i < core_parts.size(); ++i) {
    if (core_parts[i] != kNoMarker || cores[i].pixels < kLeastCore) continue;
    core_parts[i] = parts.of_unknown_turns(label.data()[cores[i].first]);
  }
}

/// Role of a pixel in the flood: a rank of the VarianceQueue while it waits, or one of these.
constexpr std::uint8_t kApart = 255;
constexpr std::uint8_t kSeed = 254;
static_assert(VarianceQueue::kRanks < kSeed);
constexpr bool waits(std::uint8_t role) { return role < kSeed; }

/// Ranks have equal width in the square root of the variance; larger variances get any rank.
PALPATE_HOT_LOOP void rank_pixels(const float* variance, float max_variance, std::uint8_t* ranks,
                                  long pixels) {
  const float per_deviation = (VarianceQueue::kRanks - 1) / std::sqrt(max_variance);
  for (long i = 0; i < pixels; ++i) {
    const float value = variance[i] < max_variance ? variance[i] : max_variance;
    ranks[i] = static_cast<std::uint8_t>(static_cast<int>(std::sqrt(value) * per_deviation));
  }
}

/// Assigns a role to the pixels of regions with several parts, and a label to the pixels of cores
/// that belong to a part.
/// \param several of each label, from -1
/// \param part of each core, from -1; negative without
PALPATE_HOT_LOOP void assign_roles(const int* core, const int* part, const int* several,
                                   int* __restrict label, std::uint8_t* __restrict role,
                                   long pixels) {
  for (long i = 0; i < pixels; ++i) {
    const int apart = several[label[i] + 1] == 0 ? 1 : 0;
    const int of_core = part[core[i] + 1];
    const bool seed = (apart == 0) & (of_core >= 0);
    const int with_seeds = seed ? kSeed : static_cast<int>(role[i]);
    role[i] = static_cast<std::uint8_t>(apart != 0 ? static_cast<int>(kApart) : with_seeds);
    label[i] = seed ? of_core : label[i];
  }
}

/// The neighbours of pixels; a pixel itself where it has none.
struct FourSides {
  const std::uint8_t* left;
  const std::uint8_t* right;
  const std::uint8_t* above;
  const std::uint8_t* below;
};

/// Finds the seeds that have waiting neighbours.
PALPATE_HOT_LOOP void find_borders(const std::uint8_t* role, FourSides sides,
                                   std::uint8_t* __restrict border, long count) {
  for (long i = 0; i < count; ++i) {
    const bool waiting = waits(sides.left[i]) | waits(sides.right[i]) | waits(sides.above[i]) |
                         waits(sides.below[i]);
    border[i] = static_cast<std::uint8_t>((role[i] == kSeed) & waiting ? 1 : 0);
  }
}

/// Queues the seeds that have waiting neighbours.
void queue_seeds(const Mask& ranks, const Mask& roles, VarianceQueue& queue) {
  const long columns = roles.cols();
  const long last = columns - 1;
  const long beside = std::min(1L, last);
  std::vector<std::uint8_t> border(static_cast<std::size_t>(columns));
  for (long row = 0; row < roles.rows(); ++row) {
    const std::uint8_t* const role = &roles(row, 0);
    const long up = row > 0 ? columns : 0;
    const long down = row + 1 < roles.rows() ? columns : 0;
    const auto find = [&](long first, long left, long right, long count) {
      const std::uint8_t* here = role + first;
      find_borders(here, {here - left, here + right, here - up, here + down}, border.data() + first,
                   count);
    };
    find(0, 0, beside, 1);
    find(beside, 1, 1, columns - 2);
    find(last, beside, 0, 1);
    for (long column = 0; column < columns; ++column) {
      if (border[static_cast<std::size_t>(column)] == 0) continue;
      queue.push(static_cast<int>(row * columns + column), ranks(row, column));
    }
  }
}

/// Floods the waiting pixels from the queued ones, in the order of their ranks.
void flood(const Plane& wrapped, double max_step, Labels& labels, Mask& roles,
           VarianceQueue& queue) {
  const int columns = static_cast<int>(wrapped.cols());
  const int last_row = static_cast<int>(wrapped.size()) - columns;
  const auto limit = static_cast<float>(max_step);
  const float across_turn = 2 * std::numbers::pi_v<float> - limit;
  const float* phase = wrapped.data();
  for (int pixel = queue.pop(); pixel >= 0; pixel = queue.pop()) {
    const int column = pixel % columns;
    const auto visit = [&](int other) {
      const std::uint8_t rank = roles.data()[other];
      if (!waits(rank)) return;
      const float step = std::abs(phase[other] - phase[pixel]);
      if (step > limit && step < across_turn) return;
      roles.data()[other] = kSeed;
      labels.data()[other] = labels.data()[pixel];
      queue.push(other, rank);
    };
    if (column > 0) visit(pixel - 1);
    if (column + 1 < columns) visit(pixel + 1);
    if (pixel >= columns) visit(pixel - columns);
    if (pixel < last_row) visit(pixel + columns);
  }
}

}  // namespace

void grow_regions(const Plane& wrapped, const Plane& variance, const FloodLimits& limits,
                  UnwrappingBuffers& buffers, Regions& regions) {
  buffers.classes.resize(wrapped.rows(), wrapped.cols());
  classify(variance.data(), static_cast<float>(limits.max_variance), buffers.classes.data(),
           variance.size());
  buffers.runs.find(wrapped, buffers.classes, limits.max_step);
  buffers.runs.write_labels(regions.label);
  buffers.runs.write_phase(wrapped, regions.phase);
  regions.count = buffers.runs.count();
}

void split_regions(const Plane& wrapped, const Plane& variance, const FloodLimits& limits,
                   const std::vector<Marker>& markers, UnwrappingBuffers& buffers,
                   Regions& regions) {
  const long pixels = wrapped.size();
  buffers.classes.resize(wrapped.rows(), wrapped.cols());
  classify(variance.data(), static_cast<float>(limits.max_variance), buffers.classes.data(),
           pixels);
  leave_out(regions.label.data(), buffers.classes.data(), pixels);
  cut_necks(buffers.classes, buffers.row_minima);
  buffers.runs.find(wrapped, buffers.classes, limits.max_step);
  buffers.runs.write_labels(buffers.cores);
  buffers.runs.measure(buffers.core_extents);

  Parts parts(regions);
  buffers.core_parts.assign(static_cast<std::size_t>(buffers.runs.count()), kNoMarker);
  vote_cores(regions.label, markers, buffers.cores, parts, buffers.core_parts);
  doubt_cores(regions.label, buffers.core_extents, parts, buffers.core_parts);
  if (!parts.any_several()) return;
  buffers.roles.resize(wrapped.rows(), wrapped.cols());
  rank_pixels(variance.data(), static_cast<float>(limits.max_variance), buffers.roles.data(),
              pixels);
  buffers.ranks = buffers.roles;
  buffers.core_parts.insert(buffers.core_parts.begin(), kNoMarker);  // of pixels in no core, -1
  assign_roles(buffers.cores.data(), buffers.core_parts.data(), parts.several().data(),
               regions.label.data(), buffers.roles.data(), pixels);
  buffers.queue.reset();
  queue_seeds(buffers.ranks, buffers.roles, buffers.queue);
  for (const Marker& marker : markers) {
    if (!waits(buffers.roles.data()[marker.pixel])) continue;
    int& label = regions.label.data()[marker.pixel];
    label = parts.with_turns(label, marker.turns);
    buffers.roles.data()[marker.pixel] = kSeed;
    buffers.queue.push(marker.pixel, buffers.ranks.data()[marker.pixel]);
  }
  flood(wrapped, limits.max_step, regions.label, buffers.roles, buffers.queue);
}

}  // namespace palpate::sensing
