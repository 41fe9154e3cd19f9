// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "palpate/geometry/camera.h"

namespace palpate::sensing {

/// One colour of the stripes.
struct PatternColor {
  std::string name;     ///< as in the trained colours
  Eigen::Vector3d rgb;  ///< red, green, blue in [0, 1]
};

/// Projector axis: x counts columns, y counts rows.
enum class Axis { x, y };

/// What the projector shows (thesis 3.2): coloured stripes, and on them the brightness
/// v = mean + amplitude cos(2 pi p / period + phase), p the projector pixel along `axis`.
/// The stripes follow each other along the other axis. A pattern without stripes has neither
/// `colors` nor `stripes` nor `stripe_edges`.
struct Pattern {
  std::vector<PatternColor> colors{};
  std::vector<int> stripes{};  ///< indices into `colors`, in the order of rising projector pixels
  std::vector<double> stripe_edges{};  ///< px; edge i lies between stripes i and i + 1
  Axis axis = Axis::y;                 ///< along which the sinusoid varies
  double period = 0;                   ///< px, > 0
  double phase = 0;                    ///< rad
  double mean = 0.5;                   ///< in [0, 1]
  double amplitude = 0.5;              ///< > 0, and v stays within [0, 1]
  /// px, columns and rows of the panel it was made for, > 0; nothing if that is not known.
  std::optional<Eigen::Vector2i> projector_size{};
};

/// \throws InvalidInput, beginning with `what`, unless: all is finite and in range; there are both
/// colours and stripes or neither; there is one edge less than stripes and the edges rise;
/// neighbouring stripes differ; and no ordered pair of neighbours appears twice (thesis 3.3.1).
void check_pattern(const Pattern& pattern, const std::string& what);

/// \throws InvalidInput, beginning with `what`, if the pattern was made for a panel of another size
/// than the projector's; or, where that is not known, if a stripe edge lies beyond the panel.
void check_pattern_fits(const Pattern& pattern, const geometry::Camera& projector,
                        const std::string& what);

/// Reads a pattern (OpenCV FileStorage: `colors`, `stripes`, `stripe_edges_px`, `axis`,
/// `period_px`, `phase`, `mean`, `amplitude`, and, which may be missing, `projector_size`).
/// \throws FileError naming the file and the key if something is missing or inconsistent.
[[nodiscard]] Pattern read_pattern(const std::filesystem::path& path);

/// Writes a pattern as `read_pattern` reads it; every number survives exactly.
/// \throws InvalidInput if the pattern is not valid; OutputError.
void write_pattern(const std::filesystem::path& path, const Pattern& pattern);

}  // namespace palpate::sensing
