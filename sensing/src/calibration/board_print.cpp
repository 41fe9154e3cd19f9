// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/sensing/board_print.h"

#include <fmt/format.h>
#include <fmt/ostream.h>

#include <ostream>

#include "palpate/core/output_file.h"

namespace palpate::sensing {

void write_board_print(const std::filesystem::path& svg, const Board& board) {
  const std::vector<BoardPatch> patches = board_patches(board);
  const double width = (board.columns + 3) * board.square;
  const double height = (board.rows + 3) * board.square;
  write_file(svg, [&](std::ostream& out) {
    fmt::print(out,
               "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}mm\" height=\"{1}mm\" "
               "viewBox=\"0 0 {0} {1}\" shape-rendering=\"crispEdges\">\n"
               "<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
               width, height);
    for (const BoardPatch& patch : patches) {
      fmt::print(out, "<rect x=\"{:.6g}\" y=\"{:.6g}\" width=\"{:.6g}\" height=\"{:.6g}\"/>\n",
                 patch.x + board.square, patch.y + board.square, patch.width, patch.height);
    }
    out << "</svg>\n";
  });
}

}  // namespace palpate::sensing
