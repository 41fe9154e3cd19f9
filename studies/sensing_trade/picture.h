// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cmath>
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::bench {

struct Curve {
  std::string name;
  std::vector<double> x, y;  ///< as many of each
};

struct Panel {
  std::string x_label, y_label;
  std::vector<Curve> curves;
  double most = HUGE_VAL;  ///< the largest value that y can have
};

/// Four panels, two by two, as a PNG of 1200 px across.
void draw_panels(const std::filesystem::path& png, const std::string& title,
                 const std::vector<Panel>& panels);

}  // namespace palpate::bench
