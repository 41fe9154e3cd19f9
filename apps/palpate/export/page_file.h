// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "shared/aliases.h"

namespace palpate::apps {

/// Pages that are longer are refused: browsers hold the text of a page in memory, and phones give
/// up on a few hundred MB.
inline constexpr std::size_t kMostPageBytes = 150'000'000;

/// The template of a page, which is installed with the command: "model", "range" or "mesh".
[[nodiscard]] fs::path page_template_path(const std::string& kind);

/// A page of kind "range" or "mesh", whose data are one block for all frames and one for each.
struct SequencePage {
  std::string kind, title;
  Json facts;                     ///< description of the data for the scripts of the page
  std::vector<std::byte> common;  ///< the first block
  std::vector<fs::path> files;    ///< the frames
  /// The block of one of `files`; called by several threads at once.
  std::function<std::vector<std::byte>(const fs::path&)> pack;
  std::size_t most_bytes = kMostPageBytes;
};

/// Writes a page frame by frame, so that its data need not be in memory together.
/// \returns the size of the page [bytes].
/// \throws InvalidInput if the page would be longer than `most_bytes`; nothing is written then.
std::size_t write_page(const fs::path& output, const SequencePage& page);

/// The values of a quantity over a sequence, for its colour scale.
class ValueRange {
 public:
  /// Values that are not finite do not count.
  void add(std::span<const double> values);
  [[nodiscard]] bool is_empty() const { return sample_.empty(); }
  [[nodiscard]] double min() const { return min_; }
  [[nodiscard]] double max() const { return max_; }
  /// "min" and "max", and "low" and "high", between which 98 % of the values lie (estimated from a
  /// part of each frame); null if there is no value.
  [[nodiscard]] Json to_json() const;

 private:
  double min_ = std::numeric_limits<double>::infinity(), max_ = -min_;
  std::vector<float> sample_;
};

}  // namespace palpate::apps
