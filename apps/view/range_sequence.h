// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "false_color.h"
#include "palpate/geometry/range_map.h"
#include "view_call.h"

namespace palpate::view {

/// A map of a sequence, as far as a layer needs it.
struct RangeFrame {
  geometry::RangeMap map;
  geometry::ImageF deviation;                    ///< [mm]; empty: not wanted, or not there
  sensing::ReasonImage reasons;                  ///< empty: not wanted, or not there
  std::optional<geometry::RangeMapScore> score;  ///< against the other sequence; if wanted
};

/// Range maps on the disk, and those that they are compared with.
class RangeSequence {
 public:
  /// \throws FileError, InvalidInput as `list_range_maps`, or if the other sequence has another
  /// number of maps and more than one.
  RangeSequence(const std::filesystem::path& path, const std::filesystem::path& compare,
                const apps::MapCamera& camera);

  [[nodiscard]] std::size_t size() const { return maps_.size(); }
  [[nodiscard]] std::string name(std::size_t frame) const;
  [[nodiscard]] bool is_compared() const { return !others_.empty(); }
  /// Returns true if there are deviations, or reasons, beside the first map.
  [[nodiscard]] bool has(MapLayer layer) const;

  /// Reads a map and the further data that the layer needs.
  /// \throws FileError, InvalidInput naming the file.
  [[nodiscard]] RangeFrame read(std::size_t frame, MapLayer layer) const;

  /// The range of the colours of a layer, in the whole sequence, by a few of its maps.
  [[nodiscard]] ColorSpan span(MapLayer layer) const;

 private:
  [[nodiscard]] std::filesystem::path beside(std::size_t frame, const char* ending) const;

  std::vector<std::filesystem::path> maps_, others_;
  apps::MapCamera camera_;
};

/// The colours of a frame in a layer.
[[nodiscard]] ColorImage color_frame(const RangeFrame& frame, MapLayer layer,
                                     const ColorSpan& span);

}  // namespace palpate::view
