// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "strip_chart.h"

#include <algorithm>

namespace palpate::view {
StripChart::StripChart(double least) : least_(least) {}

void StripChart::add(const ForceReading& reading, haptics::ContactState state) {
  entries_[next_] = {{static_cast<float>(reading.total), static_cast<float>(reading.normal),
                      static_cast<float>(reading.tangential)},
                     state};
  next_ = (next_ + 1) % kCount;
  quiet_ = state == haptics::ContactState::free ? quiet_ + 1 : 0;
}

double StripChart::top() const {
  double largest = least_;
  for (const Entry& entry : entries_) {
    largest = std::max(largest, static_cast<double>(entry.forces[0]));
  }
  return round_up(largest);
}

std::vector<StripChart::Column> StripChart::columns(Line line, int count) const {
  std::vector<Column> columns(static_cast<std::size_t>(std::max(1, count)));
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const std::size_t begin = c * kCount / columns.size();
    const std::size_t end = std::max(begin + 1, (c + 1) * kCount / columns.size());
    const auto force = [&](std::size_t i) {
      return entries_[(next_ + i) % kCount].forces[static_cast<std::size_t>(line)];
    };
    columns[c] = {force(begin), force(begin)};
    for (std::size_t i = begin + 1; i < end; ++i) {
      columns[c].low = std::min(columns[c].low, force(i));
      columns[c].high = std::max(columns[c].high, force(i));
    }
  }
  return columns;
}

std::vector<haptics::ContactState> StripChart::states(int count) const {
  std::vector<haptics::ContactState> states;
  const auto columns = static_cast<std::size_t>(std::max(1, count));
  for (std::size_t c = 0; c < columns; ++c)
    states.push_back(entries_[(next_ + (c * kCount + kCount / 2) / columns) % kCount].state);
  return states;
}

}  // namespace palpate::view
