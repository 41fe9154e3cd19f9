// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <ostream>
#include <string>
#include <vector>

#include "measure.h"

namespace palpate::bench {

/// One scene decoded in one way.
struct Row {
  std::string setting;
  std::string scene;
  Figures figures;
};

/// The figures of the scenes while one setting is varied.
struct Experiment {
  std::string name;
  std::vector<Row> rows;  ///< setting after setting
};

/// Markdown: a line for each scene, a column for each setting, in each cell the median error, the
/// RMS, coverage and the share that is wrong; below, the time.
void write_comparison(std::ostream& out, const Experiment& experiment);

/// Markdown: a line for each scene, a column for each figure; of experiments with one setting.
void write_scenes(std::ostream& out, const Experiment& experiment);

/// All figures of all experiments, a line each.
void write_csv(std::ostream& out, const std::vector<Experiment>& experiments);

}  // namespace palpate::bench
