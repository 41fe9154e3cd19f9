// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <matio.h>

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace palpate::probing {

/// A variable of a MAT file, or a field of a structure.
struct MatArray {
  matio_classes kind{};
  bool complex = false;
  std::vector<std::size_t> size;             ///< rows, columns, ...
  std::vector<double> numbers;               ///< of an array of real numbers, column by column
  std::map<std::string, MatArray> fields{};  ///< of a structure of size 1 x 1
};

/// Functions of the module `mat_array`: libmatio, which needs HDF5, and with it 30 other shared
/// libraries.
struct MatArrays {
  /// All variables of a file by their names.
  /// \throws FileError naming the file, what is wrong, and what would be right.
  std::map<std::string, MatArray> (*read)(const std::filesystem::path& path);
};

}  // namespace palpate::probing

extern "C" const palpate::probing::MatArrays palpate_mat_array;
