// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "shared/aliases.h"

namespace palpate::apps {

/// Data whose settings are tried. Empty paths stand for data that are not given.
struct TradeData {
  enum class Kind { acquisition, model, mesh };
  Kind kind = Kind::mesh;
  fs::path file, surface, queries, trajectory;
  std::optional<int> strokes = {};  ///< of `reduce`
};

/// The error and the costs of one setting.
struct TradePoint {
  std::string settings;  ///< the command without its files
  double error = 0;
  double bytes = 0;
  double seconds = 0;               ///< of the command
  std::optional<double> step = {};  ///< [us] of the haptic loop
  bool best_by_size = false, best_by_time = false;
};

/// The points of a sweep, and the name and unit of their errors.
struct Trade {
  std::string error, unit;
  std::vector<TradePoint> points;
  std::vector<std::string> failures;
};

/// Calls the commands for some data with many settings, one after the other. Settings with the same
/// result as earlier ones make no point.
/// \param work an empty folder for the outputs.
/// \param told called after each new point.
/// \throws InvalidInput if `fit` with its defaults fails, or all settings fail.
[[nodiscard]] Trade try_settings(const TradeData& data, const fs::path& work,
                                 const std::function<void(const Trade& trade)>& told);

}  // namespace palpate::apps
