// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/smooth_runs.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <numbers>

#include "image/hot_loop.h"

namespace palpate::sensing {
namespace {

/// Link of two neighbours: none, a step without a turn (kLevel), or a step with one turn down or
/// up.
constexpr std::uint8_t kNoLink = 0;
constexpr std::uint8_t kLevel = 2;

/// The links from `phase` to `other`.
PALPATE_HOT_LOOP void find_links(const float* phase, const float* other,
                                 const std::uint8_t* classes, const std::uint8_t* other_classes,
                                 float max_step, std::uint8_t* links, long pixels) {
  constexpr float kPi = std::numbers::pi_v<float>;
  for (long i = 0; i < pixels; ++i) {
    const float difference = other[i] - phase[i];
    const int turns = (difference < -kPi ? 1 : 0) - (difference > kPi ? 1 : 0);
    const float step = difference + 2 * kPi * static_cast<float>(turns);
    const bool near = (step <= max_step) & (step >= -max_step);
    const bool smooth = (classes[i] != kNotSmooth) & (other_classes[i] != kNotSmooth);
    links[i] = static_cast<std::uint8_t>((near & smooth) ? kLevel + turns : kNoLink);
  }
}

/// Finds the starts of runs: the class changes, or the step from the left needs a turn or is too
/// large. `links` are those to the right.
PALPATE_HOT_LOOP void find_starts(const std::uint8_t* classes, const std::uint8_t* links,
                                  std::uint8_t* starts, long pixels) {
  starts[0] = 1;
  for (long i = 1; i < pixels; ++i) {
    const bool change = classes[i] != classes[i - 1];
    const bool apart = (classes[i] != kNotSmooth) & (links[i - 1] != kLevel);
    starts[i] = (change | apart) ? 1 : 0;
  }
}

PALPATE_HOT_LOOP void find_events(const std::uint8_t* starts, const std::uint8_t* above,
                                  const std::uint8_t* down, std::uint8_t* events, long pixels) {
  events[0] = 1;
  for (long i = 1; i < pixels; ++i) {
    events[i] = static_cast<std::uint8_t>(starts[i] | above[i] | (down[i] != down[i - 1] ? 1 : 0));
  }
}

PALPATE_HOT_LOOP void add_constant(const float* in, float value, float* out, long pixels) {
  for (long i = 0; i < pixels; ++i) out[i] = in[i] + value;
}

/// Calls `each(i)` for the bytes that are 1; `bytes` has a multiple of eight.
template <typename Each>
void for_each_set(const std::vector<std::uint8_t>& bytes, const Each& each) {
  static_assert(std::endian::native == std::endian::little);
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(std::uint64_t)) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes.data() + i, sizeof word);
    for (; word != 0; word &= word - 1) {
      each(i + static_cast<std::size_t>(std::countr_zero(word)) / 8);
    }
  }
}

}  // namespace

void SmoothRuns::start_rows(long rows, long columns) {
  rows_ = rows;
  columns_ = columns;
  runs_.clear();
  nodes_.clear();
  for (auto& links : links_) links.clear();
  // Pad the row with zeros to a multiple of eight.
  const auto padded = (static_cast<std::size_t>(columns) + 7) / 8 * 8;
  for (auto* bytes : {&across_, &down_, &starts_, &above_, &events_}) bytes->assign(padded, 0);
  first_above_ = 0;
}

int SmoothRuns::root_of(int run) {
  for (;;) {
    Node& node = nodes_[static_cast<std::size_t>(run)];
    if (node.parent == run) return run;
    // Path halving; a root has no turns relative to itself.
    const Node& parent = nodes_[static_cast<std::size_t>(node.parent)];
    node.turns += parent.turns;
    node.parent = parent.parent;
    run = node.parent;
  }
}

void SmoothRuns::join(const Link& link) {
  const int a = root_of(link.a);
  const int b = root_of(link.b);
  if (a == b) return;
  const auto turns_over = [&](int run, int root) {
    int turns = 0;
    for (int at = run; at != root;) {
      const Node& node = nodes_[static_cast<std::size_t>(at)];
      turns += node.turns;
      at = node.parent;
    }
    return turns;
  };
  // phase(b) = phase(a) + turns; the first of the two roots stays.
  const int over = turns_over(link.a, a) + link.turns - turns_over(link.b, b);
  if (a < b) {
    nodes_[static_cast<std::size_t>(b)] = {a, over};
  } else {
    nodes_[static_cast<std::size_t>(a)] = {b, -over};
  }
}

void SmoothRuns::add_link(const Link& link) {
  const int rank = std::max(runs_[static_cast<std::size_t>(link.a)].label,
                            runs_[static_cast<std::size_t>(link.b)].label);
  if (rank == 0) {
    join(link);
  } else {
    links_[static_cast<std::size_t>(rank)].push_back(link);
  }
}

void SmoothRuns::scan_row(const float* phase, const std::uint8_t* classes, int row,
                          float max_step) {
  find_links(phase, phase + 1, classes, classes + 1, max_step, across_.data(), columns_ - 1);
  find_starts(classes, across_.data(), starts_.data(), columns_);
  if (row > 0) {
    find_links(phase - columns_, phase, classes - columns_, classes, max_step, down_.data(),
               columns_);
  }
  find_events(starts_.data(), above_.data(), down_.data(), events_.data(), columns_);
  const int first = static_cast<int>(runs_.size());
  int above = first_above_ - 1;
  for_each_set(events_, [&](std::size_t column) {
    if (above_[column] != 0) ++above;
    if (starts_[column] != 0) {
      const int run = static_cast<int>(runs_.size());
      runs_.push_back({row * static_cast<int>(columns_) + static_cast<int>(column),
                       static_cast<int>(classes[column])});
      nodes_.push_back({run, 0});
      if (column > 0 && across_[column - 1] != kNoLink) {
        add_link({run - 1, run, across_[column - 1] - kLevel});
      }
    }
    if (down_[column] != kNoLink) {
      add_link({above, static_cast<int>(runs_.size()) - 1, down_[column] - kLevel});
    }
  });
  std::swap(starts_, above_);
  first_above_ = first;
}

void SmoothRuns::label_runs() {
  count_ = 0;
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    Node& node = nodes_[i];
    if (runs_[i].label == kNotSmooth) {
      runs_[i].label = -1;
    } else if (node.parent == static_cast<int>(i)) {
      runs_[i].label = count_++;
    } else {
      // A parent comes before its children, so it already points at its root.
      const Node& parent = nodes_[static_cast<std::size_t>(node.parent)];
      node = {parent.parent, node.turns + parent.turns};
      runs_[i].label = runs_[static_cast<std::size_t>(node.parent)].label;
    }
  }
}

void SmoothRuns::find(const Plane& wrapped, const Mask& classes, double max_step) {
  start_rows(wrapped.rows(), wrapped.cols());
  if (wrapped.size() > 0) {
    for (int row = 0; row < static_cast<int>(rows_); ++row) {
      scan_row(&wrapped(row, 0), &classes(row, 0), row, static_cast<float>(max_step));
    }
  }
  for (const auto& links : links_) {
    for (const Link& link : links) join(link);
  }
  label_runs();
}

template <typename Each>
void SmoothRuns::for_each_run(const Each& each) const {
  for (std::size_t i = 0; i < runs_.size(); ++i) {
    const int end = i + 1 < runs_.size() ? runs_[i + 1].first : static_cast<int>(rows_ * columns_);
    each(i, runs_[i].first, end - runs_[i].first);
  }
}

void SmoothRuns::write_labels(Labels& labels) const {
  labels.resize(rows_, columns_);
  for_each_run([&](std::size_t run, int first, int length) {
    std::fill_n(labels.data() + first, length, runs_[run].label);
  });
}

void SmoothRuns::write_phase(const Plane& wrapped, Plane& phase) const {
  phase.resize(rows_, columns_);
  for_each_run([&](std::size_t run, int first, int length) {
    add_constant(wrapped.data() + first,
                 2 * std::numbers::pi_v<float> * static_cast<float>(nodes_[run].turns),
                 phase.data() + first, length);
  });
}

void SmoothRuns::measure(std::vector<Extent>& extents) const {
  extents.assign(static_cast<std::size_t>(count_), Extent{});
  for_each_run([&](std::size_t run, int first, int length) {
    if (runs_[run].label < 0) return;
    Extent& extent = extents[static_cast<std::size_t>(runs_[run].label)];
    if (extent.pixels == 0) extent.first = first;
    extent.pixels += length;
  });
}

}  // namespace palpate::sensing
