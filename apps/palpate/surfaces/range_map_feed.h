// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstddef>
#include <functional>
#include <optional>
#include <set>
#include <vector>

#include "shared/map_camera.h"

namespace palpate::apps {

/// The range maps of a folder in their order, also while another program adds some.
class RangeMapFeed {
 public:
  /// \param patience [s] how long to wait for a range map after the one before; without it, the
  /// folder does not grow.
  /// \throws FileError or InvalidInput as `list_range_maps`, for a folder that does not grow.
  RangeMapFeed(fs::path folder, const MapCamera& camera, std::optional<double> patience);

  /// The range maps known so far.
  [[nodiscard]] const std::vector<fs::path>& known() const { return known_; }

  /// Returns true as soon as the range map with this index is written completely, and false if it
  /// does not come. A file is complete if another one follows it, or if it did not change between
  /// two looks.
  /// \param while_waiting is called before each look.
  /// \throws InvalidInput as `list_range_maps`.
  /// \throws FileError if the last known one was removed, or the folder still has none at the end.
  [[nodiscard]] bool wait_for(std::size_t index, const std::function<void()>& while_waiting);

 private:
  /// Adds those that have come to `known_`.
  void look();
  void add_new(const std::vector<fs::path>& listed);

  fs::path folder_;
  MapCamera camera_;
  std::optional<std::chrono::duration<double>> patience_;
  std::vector<fs::path> known_;
  std::set<fs::path> late_;  ///< came after others that follow them
};

}  // namespace palpate::apps
