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

/// A stripe colour.
struct PatternColor {
  std::string name;     ///< as in the trained colours
  Eigen::Vector3d rgb;  ///< red, green, blue in [0, 1]
};

/// Largest number of colours of a pattern; hues of more than about a dozen cannot be told apart.
inline constexpr std::size_t kMostPatternColors = 63;

/// Axis of the projector image: x counts columns, y counts rows.
enum class Axis { x, y };

/// Images of a scene that holds still, projected one after the other: first the pattern's sinusoid
/// in several positions, image k showing mean + amplitude cos(2 pi p / period + phase + shifts[k]),
/// then the bits of a Gray code that tells the periods apart, from the highest bit to the lowest.
/// The code numbers cells of equal width along `Pattern::axis`; a bit that is set is as bright as
/// the crests of the sinusoid (mean + amplitude), any other as dark as its troughs.
struct Multishot {
  std::vector<double> shifts{};  ///< rad, 3 to 64 of them, which determine a sinusoid
  int code_bits = 0;             ///< number of images of the code; in [1, 16]
  /// px, > 0, at most 3/4 of the period. Half a period is best: the edges of the lowest bit are
  /// then as far as possible from those of all others, and any single bit that is misread
  /// contradicts the phase.
  double code_cell = 0;
  double code_start = -0.5;  ///< px, start of the first cell
};

/// The projected pattern (thesis 3.2): coloured stripes whose brightness varies as the sinusoid
/// v = mean + amplitude cos(2 pi p / period + phase), where p is the projector pixel along `axis`.
/// The stripes are side by side along the other axis. A pattern without stripes has no `colors`,
/// `stripes` or `stripe_edges`.
struct Pattern {
  std::vector<PatternColor> colors{};
  std::vector<int> stripes{};  ///< indices into `colors`, by increasing projector coordinate
  std::vector<double> stripe_edges{};  ///< px; edge i lies between stripes i and i + 1
  Axis axis = Axis::y;                 ///< the axis along which the sinusoid varies
  double period = 0;                   ///< px, > 0
  double phase = 0;                    ///< rad
  double mean = 0.5;                   ///< in [0, 1]
  double amplitude = 0.5;              ///< > 0, and v stays within [0, 1]
  /// px, columns and rows (> 0) of the panel the pattern was made for; empty if unknown.
  std::optional<Eigen::Vector2i> projector_size{};
  /// If given, several images show the scene, and there are no stripes.
  std::optional<Multishot> multishot{};
};

/// Checks a pattern: all values are finite and in range; colours and stripes are both present or
/// both absent; there is one edge fewer than stripes, and the edges increase; neighbouring stripes
/// differ; no ordered pair of neighbouring colours appears twice (thesis 3.3.1); and several images
/// of a still scene determine the phase (see `Multishot`).
/// \throws InvalidInput otherwise; the message begins with `what`.
void check_pattern(const Pattern& pattern, const std::string& what);

/// Checks that a pattern fits the projector's panel.
/// \throws InvalidInput if the pattern was made for a panel of another size or, if its size is
/// unknown, if a stripe edge lies outside the panel; the message begins with `what`.
void check_pattern_fits(const Pattern& pattern, const geometry::Camera& projector,
                        const std::string& what);

/// Reads a pattern from OpenCV FileStorage: `colors`, `stripes`, `stripe_edges_px`, `axis`,
/// `period_px`, `phase`, `mean`, `amplitude`, and optionally `projector_size` and `multishot` (with
/// `shifts`, `code_bits`, `code_cell_px`, and optionally `code_start_px`).
/// \throws FileError naming the file and the key if a value is missing or inconsistent.
[[nodiscard]] Pattern read_pattern(const std::filesystem::path& path);

/// Writes a pattern so that `read_pattern` reads every number back exactly.
/// \throws InvalidInput if the pattern is not valid.
/// \throws OutputError if the file cannot be written.
void write_pattern(const std::filesystem::path& path, const Pattern& pattern);

}  // namespace palpate::sensing
