// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "decode/color_evidence.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <utility>
#include <vector>

namespace palpate::sensing {
namespace {

/// A colour is evidence for a patch if it covers at least this share of the patch's pixels that
/// are well inside a stripe; a smaller share may be a stripe edge displaced by blur.
constexpr double kLeastEvidenceShare = 0.05;

/// Pixels of a row with a depth, none missing between them.
struct Run {
  long row = 0;
  long begin = 0;
  long end = 0;
};

void add_runs(const std::uint8_t* known, long row, long columns, std::vector<Run>& runs) {
  const auto next = [&](long from, int value) {
    const void* const found =
        std::memchr(known + from, value, static_cast<std::size_t>(columns - from));
    return found == nullptr ? columns : static_cast<const std::uint8_t*>(found) - known;
  };
  for (long begin = next(0, 1); begin < columns;) {
    const long end = next(begin, 0);
    runs.push_back({row, begin, end});
    begin = next(end, 1);
  }
}

/// Connected sets of runs.
class Patches {
 public:
  explicit Patches(const std::vector<Run>& runs) : parent_(runs.size()) {
    for (std::size_t i = 0; i < parent_.size(); ++i) parent_[i] = i;
    std::size_t above = 0;
    for (std::size_t here = 0; here < runs.size(); ++here) {
      const Run& run = runs[here];
      while (runs[above].row < run.row - 1 ||
             (runs[above].row == run.row - 1 && runs[above].end <= run.begin))
        ++above;
      // The last of the runs above may also touch the next run of this row.
      for (std::size_t i = above; runs[i].row == run.row - 1 && runs[i].begin < run.end; ++i)
        parent_[root(here)] = root(i);
    }
  }
  [[nodiscard]] std::size_t root(std::size_t run) {
    while (parent_[run] != run) run = parent_[run] = parent_[parent_[run]];
    return run;
  }

 private:
  std::vector<std::size_t> parent_;
};

/// Number of pixels of a patch for each value of ColorSays.
using Counts = std::array<int, 256>;

bool is_proven(const Counts& counts, int colors) {
  int all = 0;
  for (int color = 0; color < colors; ++color) {
    const auto at = static_cast<std::size_t>(color);
    all += counts[at] + counts[at + kConfirms];
  }
  int speaking = 0;
  for (int color = 0; color < colors; ++color) {
    const auto at = static_cast<std::size_t>(color);
    const int agreeing = counts[at + kConfirms];
    const int wanted = counts[at] + agreeing;
    if (wanted >= kLeastEvidenceShare * all && wanted > 0 && 2 * agreeing > wanted) ++speaking;
  }
  return speaking >= 2;
}

}  // namespace

void find_unproven_patches(const Plane& z, const ColorSays& says, int colors, Mask& marked) {
  const long columns = z.cols();
  marked = (z == z).cast<std::uint8_t>();
  std::vector<Run> runs;
  for (long row = 0; row < z.rows(); ++row) add_runs(&marked(row, 0), row, columns, runs);
  Patches patches(runs);
  // The runs of each patch one after the other.
  std::vector<std::pair<std::size_t, std::size_t>> order;
  for (std::size_t i = 0; i < runs.size(); ++i) order.emplace_back(patches.root(i), i);
  std::sort(order.begin(), order.end());

  marked.setZero();
  for (auto first = order.begin(); first != order.end();) {
    const auto last = std::find_if(first, order.end(),
                                   [&](const auto& other) { return other.first != first->first; });
    // Neighbours mostly have the same value; with one table, each count would wait for the last.
    std::array<Counts, 2> counts{};
    for (auto at = first; at != last; ++at) {
      const Run& run = runs[at->second];
      const std::uint8_t* const said = &says(run.row, 0);
      for (long i = run.begin; i < run.end; ++i) ++counts[static_cast<std::size_t>(i % 2)][said[i]];
    }
    for (std::size_t i = 0; i < counts[0].size(); ++i) counts[0][i] += counts[1][i];
    if (!is_proven(counts[0], colors)) {
      for (auto at = first; at != last; ++at) {
        const Run& run = runs[at->second];
        marked.row(run.row).segment(run.begin, run.end - run.begin).setOnes();
      }
    }
    first = last;
  }
}

}  // namespace palpate::sensing
