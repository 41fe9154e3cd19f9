// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "seeing/printed_board.h"

#include <fmt/format.h>

#include <string_view>
#include <tuple>

#include "palpate/core/error.h"
#include "shared/call_checks.h"

namespace palpate::apps {

std::pair<int, int> parse_pair(const std::string& text, const char* option) {
  if (const auto pair = pair_of(text, 'x')) return *pair;
  throw InvalidInput(fmt::format("{}: '{}' is not of the form 7x9.", option, text));
}

void PrintedBoard::parse() {
  if (text.empty()) return;
  constexpr std::string_view kCharuco = "charuco:";
  const bool has_markers = text.starts_with(kCharuco);
  std::tie(printed.columns, printed.rows) =
      parse_pair(has_markers ? text.substr(kCharuco.size()) : text, "--board");
  if (!has_markers) {
    if (printed.marker > 0)
      throw InvalidInput("--marker: only for --board charuco:...; a chessboard has no markers.");
    return;
  }
  --printed.columns;
  --printed.rows;
  if (!(printed.marker > 0)) {
    throw InvalidInput(
        "--board charuco:... needs --marker, the side of its markers in mm, outer edge to outer "
        "edge of their black border.");
  }
}

std::string PrintedBoard::options() const {
  std::string words = fmt::format("--board {} --square {:g}", text, printed.square);
  if (printed.marker > 0)
    words += fmt::format(" --marker {:g} --marker-bits {}", printed.marker, printed.marker_bits);
  return words;
}

void add_board_options(CLI::App& command, PrintedBoard& board) {
  command.add_option("--board", board.text,
                     "Inner corners of the printed chessboard, such as 7x9; or the squares of a "
                     "ChArUco board, such as charuco:8x11");
  add_number(command, "--square", board.printed.square, above(0), "Side of a square [mm]");
  add_number(command, "--marker", board.printed.marker, above(0),
             "Side of a ChArUco board's markers [mm]");
  add_word(command, "--marker-bits", board.printed.marker_bits, {"4", "5", "6", "7"},
           "Bits along the side of such a marker: 4 for DICT_4X4, 5, 6 or 7")
      ->capture_default_str();
}

}  // namespace palpate::apps
