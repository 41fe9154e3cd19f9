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
  Eigen::VectorXd y;  ///< one per x; NaN interrupts the line
};

/// Labels of the axes: quantity and unit.
struct SectionLabels {
  std::string x = "x (mm)";
  std::string y = "z (mm)";
};

/// Draws several lines in one chart as a PNG of 1200 x 700 px, for example cross-sections of
/// surfaces. The first is on top; up to three lines get broader from top to bottom, so that each is
/// seen where all coincide. Series named red, green, blue or grey get that colour; the others get
/// one of six colours, which repeat. Works without a display.
/// \throws InvalidInput, naming the series, if there is none, if x and y differ in size, or if
/// nothing is finite.
/// \throws OutputError if the picture cannot be written.
void draw_section(const std::filesystem::path& png, std::span<const SectionSeries> series,
                  const std::string& title, const SectionLabels& labels = {});

}  // namespace palpate::pictures
