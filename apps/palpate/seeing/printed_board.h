// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <utility>

#include "palpate/sensing/board_views.h"

namespace palpate::apps {

/// A board as the user describes it.
struct PrintedBoard {
  std::string text;  ///< 7x9, a chessboard's inner corners, or charuco:8x11, a ChArUco board's
                     ///< squares, which is how other programs describe such boards
  sensing::Board printed;  ///< its columns and rows are those of `text` after `parse`

  /// \throws InvalidInput if `text` has another form or does not suit the marker; not if it is
  /// empty.
  void parse();
  /// The options that describe it, for a command that the user may copy.
  [[nodiscard]] std::string options() const;
};

/// Adds --board, --square, --marker and --marker-bits.
void add_board_options(CLI::App& command, PrintedBoard& board);

/// Parses two whole numbers such as 1024x768.
/// \throws InvalidInput.
[[nodiscard]] std::pair<int, int> parse_pair(const std::string& text, const char* option);

}  // namespace palpate::apps
