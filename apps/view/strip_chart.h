// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "force_reading.h"

namespace palpate::view {

/// The forces of the last seconds: total, normal and tangential; below them a band that says stick
/// or slip.
class StripChart {
 public:
  static constexpr int kSeconds = 5;
  static constexpr std::size_t kCount = 1000 * kSeconds;  ///< ticks that are kept

  /// \param least [N] that the chart shows at least
  explicit StripChart(double least);

  void add(const ForceReading& reading, haptics::ContactState state);
  /// Returns true if there was no force in all of the ticks that are kept.
  [[nodiscard]] bool is_empty() const { return quiet_ >= kCount; }
  /// [N] at the top: a round number.
  [[nodiscard]] double top() const;

  /// The lowest and the highest force of the ticks that share a column of the picture, from the
  /// oldest on: a short peak is not lost.
  struct Column {
    float low = 0, high = 0;  ///< [N]
  };
  enum class Line { total, normal, tangential };
  [[nodiscard]] std::vector<Column> columns(Line line, int count) const;
  /// The state in the middle of each column.
  [[nodiscard]] std::vector<haptics::ContactState> states(int count) const;

 private:
  struct Entry {
    std::array<float, 3> forces{};  // [N] by Line
    haptics::ContactState state = haptics::ContactState::free;
  };
  std::vector<Entry> entries_ = std::vector<Entry>(kCount);
  std::size_t next_ = 0, quiet_ = kCount;
  double least_;
};

}  // namespace palpate::view
