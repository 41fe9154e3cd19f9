// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::probing {

/// Classes of arrays in a MAT file of level 5 (MATLAB, "MAT-File Format", table 1-3).
enum class MatClass : std::uint8_t {
  cell = 1,
  structure,
  object,
  character,
  sparse,
  double_precision,
  single_precision,
  int8,
  uint8,
  int16,
  uint16,
  int32,
  uint32,
  int64,
  uint64
};

/// A variable, or a field of a structure.
struct MatArray {
  MatClass kind{};
  bool complex = false;
  std::vector<std::size_t> size;             ///< rows, columns, ...
  std::uint32_t stored = 0;                  ///< type of the numbers in `bytes` (table 1-1)
  std::string_view bytes;                    ///< numbers, column by column
  std::map<std::string, MatArray> fields{};  ///< of a structure of size 1 x 1
};

/// All variables of a file.
struct MatVariables {
  std::map<std::string, MatArray> by_name;
  bool swapped = false;            ///< the file has the other byte order than this machine
  std::deque<std::string> memory;  ///< what the `bytes` point into
};

/// \param content of the whole file
/// \throws FileError naming `path`, the place, and what would be right.
[[nodiscard]] MatVariables parse_mat(std::string content, const std::string& path);

/// The numbers of an array of numbers, column by column.
[[nodiscard]] std::vector<double> numbers_of(const MatArray& array, bool swapped);

}  // namespace palpate::probing
