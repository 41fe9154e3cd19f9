// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <vector>

#include "palpate/sensing/board_views.h"

namespace palpate::sensing {

/// A black rectangle of a print [mm]: x to the right, y down, from the board's outer corner.
struct BoardPatch {
  double x = 0, y = 0, width = 0, height = 0;
};

/// The black parts of a board: squares, and the cells of a ChArUco board's markers. The first inner
/// corner lies at (square, square).
/// \throws InvalidInput if the board is not valid.
[[nodiscard]] std::vector<BoardPatch> board_patches(const Board& board);

/// Writes the board as an SVG drawing in true size, with a white margin of one square.
/// \throws InvalidInput if the board is not valid, OutputError if the file cannot be written.
void write_board_print(const std::filesystem::path& svg, const Board& board);

}  // namespace palpate::sensing
