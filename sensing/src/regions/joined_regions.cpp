// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "regions/joined_regions.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "image/hue.h"

namespace palpate::sensing {
namespace {

/// Pixels at the end of a run whose phase is mixed with that beyond, and the pixels after them from
/// which the slope is measured.
constexpr int kMixedPixels = 2;
constexpr int kLeastEndPixels = 6;
constexpr int kEndPixels = 12;

/// Every second row is looked at; neighbours have nearly the same noise.
constexpr long kBridgeRowStep = 2;

/// Smallest number of rows in which a gap is crossed.
constexpr std::size_t kLeastBridges = 8;
/// A row agrees with a whole number of turns if it is this close, this share of the rows must, and
/// their mean must be this close to it [turns].
constexpr double kNearBridgeTurns = 0.25;
constexpr double kAgreeingRows = 0.8;
constexpr double kMeanBridgeTurns = 0.12;

/// The link between two regions in one row; `from` < `to`.
struct Bridge {
  int from = 0;
  int to = 0;
  double turns = 0;  ///< to be added to the phase of `to` to continue that of `from`
};

struct Link {
  int from = 0;
  int to = 0;
  int turns = 0;
  std::size_t rows = 0;
};

std::vector<Bridge> find_bridges(const Regions& regions, const std::vector<std::uint8_t>& open,
                                 int max_gap) {
  std::vector<Bridge> bridges;
  const int columns = static_cast<int>(regions.label.cols());
  for (int row = 0; row < regions.label.rows(); row += kBridgeRowStep) {
    const int* const label = &regions.label(row, 0);
    int last = -1;  // pixel of a region
    for (int column = 0; column < columns; ++column) {
      const int here = label[column];
      if (here < 0) continue;
      const int before = last < 0 ? here : label[last];
      if (before != here && column - last <= max_gap && open[static_cast<std::size_t>(here)] != 0 &&
          open[static_cast<std::size_t>(before)] != 0) {
        const auto left = phase_end(regions, row, last, -1);
        const auto right = phase_end(regions, row, column, 1);
        if (left && right) {
          const double step = (left->slope + right->slope) / 2 * (column - last);
          const double turns = (left->phase + step - right->phase) / kFullTurn;
          bridges.push_back(before < here ? Bridge{before, here, turns}
                                          : Bridge{here, before, -turns});
        }
      }
      last = column;
    }
  }
  return bridges;
}

/// The link of rows that cross between the same two regions.
std::optional<Link> judge_bridges(std::vector<Bridge>::iterator first,
                                  std::vector<Bridge>::iterator last) {
  const auto rows = static_cast<std::size_t>(last - first);
  if (rows < kLeastBridges) return std::nullopt;
  const auto middle = first + (last - first) / 2;
  std::nth_element(first, middle, last,
                   [](const Bridge& a, const Bridge& b) { return a.turns < b.turns; });
  const double whole = std::round(middle->turns);
  double near = 0;
  double lean = 0;
  for (auto bridge = first; bridge != last; ++bridge) {
    if (std::abs(bridge->turns - whole) > kNearBridgeTurns) continue;
    ++near;
    lean += bridge->turns - whole;
  }
  if (near < kAgreeingRows * static_cast<double>(rows)) return std::nullopt;
  if (std::abs(lean) > kMeanBridgeTurns * near) return std::nullopt;
  return Link{first->from, first->to, static_cast<int>(whole), rows};
}

std::vector<Link> find_region_links(std::vector<Bridge> bridges) {
  const auto pair = [](const Bridge& bridge) { return std::tie(bridge.from, bridge.to); };
  std::stable_sort(bridges.begin(), bridges.end(),
                   [&](const Bridge& a, const Bridge& b) { return pair(a) < pair(b); });
  std::vector<Link> links;
  for (auto first = bridges.begin(); first != bridges.end();) {
    const auto last = std::find_if(
        first, bridges.end(), [&](const Bridge& other) { return pair(other) != pair(*first); });
    if (const auto link = judge_bridges(first, last)) links.push_back(*link);
    first = last;
  }
  std::stable_sort(links.begin(), links.end(),
                   [](const Link& a, const Link& b) { return a.rows > b.rows; });
  return links;
}

}  // namespace

std::optional<PhaseEnd> phase_end(const Regions& regions, int row, int column, int inward) {
  const int* const label = &regions.label(row, 0);
  const int columns = static_cast<int>(regions.label.cols());
  const int region = label[column];
  double count = 0, sum = 0, moment = 0, square = 0, product = 0;
  for (int i = kMixedPixels; i < kMixedPixels + kEndPixels; ++i) {
    const int at = column + inward * i;
    if (at < 0 || at >= columns || label[at] != region) break;
    const auto phase = static_cast<double>(regions.phase(row, at));
    const double x = inward * i;
    count += 1;
    sum += phase;
    moment += x;
    square += x * x;
    product += x * phase;
  }
  if (count < kLeastEndPixels) return std::nullopt;
  const double slope = (count * product - moment * sum) / (count * square - moment * moment);
  return PhaseEnd{column, (sum - slope * moment) / count, slope};
}

void join_regions(const Regions& regions, const std::vector<std::uint8_t>& open, int max_gap,
                  JoinedRegions& joined) {
  joined.group.assign(open.size(), JoinedRegions::kNone);
  joined.turns.assign(open.size(), 0);
  joined.count = 0;
  std::vector<std::vector<int>> members;
  for (std::size_t region = 0; region < open.size(); ++region) {
    if (open[region] == 0) continue;
    joined.group[region] = static_cast<int>(members.size());
    members.push_back({static_cast<int>(region)});
  }
  // The strongest links first; one that contradicts them is wrong.
  for (const Link& link : find_region_links(find_bridges(regions, open, max_gap))) {
    const auto from = static_cast<std::size_t>(link.from);
    const auto to = static_cast<std::size_t>(link.to);
    if (joined.group[from] == joined.group[to]) continue;
    const int more = joined.turns[from] + link.turns - joined.turns[to];
    std::vector<int>& moving = members[static_cast<std::size_t>(joined.group[to])];
    const int group = joined.group[from];
    for (const int region : moving) {
      joined.turns[static_cast<std::size_t>(region)] += more;
      joined.group[static_cast<std::size_t>(region)] = group;
      members[static_cast<std::size_t>(group)].push_back(region);
    }
    moving.clear();
  }
  // Number the groups that are left.
  std::vector<int> number(members.size(), JoinedRegions::kNone);
  for (int& group : joined.group) {
    if (group < 0) continue;
    int& of_group = number[static_cast<std::size_t>(group)];
    if (of_group < 0) of_group = joined.count++;
    group = of_group;
  }
}

}  // namespace palpate::sensing
