// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <string>
#include <vector>

#include "assessment.h"
#include "objects.h"
#include "strategies.h"

namespace palpate::bench {

/// The subjects of the comparison.
struct ComparisonOptions {
  std::vector<std::string> strategies;  ///< names of `strategy_names`; empty: all
  bool left_out = false;                ///< `Assessment::left_out_inside` and `left_out_border`
};

/// "thesis", "static", "searching", "plain", "adaptive", "adaptive static", "adaptive searching":
/// `adaptive` has a fifth of the samples and a quarter of the hours of the thesis' programme; the
/// other two have the hours of the strategies that they are named after. "baked" computes exact
/// samples without an arm.
[[nodiscard]] const std::vector<std::string>& strategy_names();

/// One strategy on one object with one seed.
struct Run {
  int samples = 0, slipped = 0;
  double hours = 0;
  double stated = 0;  ///< [N]; NaN: nothing stated
  Assessment against_truth;
  double fit_seconds = 0;
};

/// Runs of one object, by strategy, one for each seed. Prints progress on standard error.
using Runs = std::map<std::string, std::vector<Run>>;
[[nodiscard]] Runs compare(const PreparedObject& object, const ComparisonOptions& options);

}  // namespace palpate::bench
