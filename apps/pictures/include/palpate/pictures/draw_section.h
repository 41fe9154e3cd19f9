// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string>

namespace palpate::pictures {

struct SectionSeries {
  std::string name;
  Eigen::VectorXd x;
  Eigen::VectorXd y;  ///< as many as x; NaN breaks the line
};

/// What stands at the axes: quantity and unit.
struct SectionLabels {
  std::string x = "x (mm)";
  std::string y = "z (mm)";
};

/// Draws lines over one another as a PNG of 1200 x 700 px: cross-sections of surfaces, for one. Up
/// to six colours, then they repeat. Works without a display.
/// \throws InvalidInput naming the series if there is none, if x and y differ in size, or if
/// nothing is finite; OutputError.
void draw_section(const std::filesystem::path& png, std::span<const SectionSeries> series,
                  const std::string& title, const SectionLabels& labels = {});

}  // namespace palpate::pictures
