// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/geometry/eigen_alignment.h"

namespace palpate::probing {

/// The names of the columns of a table in a file: by name, or in a CSV file also by number, as
/// "column_1". Text that names no column of the file may also be the content of all cells: a
/// number, nothing, or `kRowNumber`. A column with a minus sign before its name, such as "-Fz", has
/// its numbers negated.
using ColumnNames = std::map<std::string, std::string, std::less<>>;

/// The number of the row in place of the content of a column.
inline constexpr std::string_view kRowNumber = "row_number";

/// The layout of a table of another program.
struct TableLayout {
  /// Between the cells of a CSV file. Default: the most frequent of comma, semicolon and tab in the
  /// first line; not the comma if it is the decimal sign.
  std::optional<char> separator = std::nullopt;
  bool header = true;          ///< the first line of a CSV file names the columns
  bool decimal_comma = false;  ///< numbers of a CSV file are such as 1,5, without a point
  bool mapped = false;         ///< a mapping says so; messages then tell how it can be changed
  /// The names that columns have in the file, by the names that they are asked for.
  ColumnNames names = {};
  /// The same for columns that are not in `names`, if the file has no column of that name.
  ColumnNames defaults = {};
  long long first_row = 1;  ///< number of the first row
};

/// A file without a column that is asked for.
struct MissingColumn : FileError {
  MissingColumn(const std::string& message, std::string column)
      : FileError(message), name(std::move(column)) {}
  std::string name;  ///< as it is asked for
};

/// The rows of a table of any kind of file, one after the other. Columns are known by their index
/// among those that were asked for.
class TableReader {
 public:
  TableReader() = default;
  TableReader(const TableReader&) = delete;
  TableReader& operator=(const TableReader&) = delete;
  virtual ~TableReader() = default;

  /// Moves to the first row, and from each row to the next one. False if there is none.
  /// \throws FileError if the row is damaged.
  [[nodiscard]] virtual bool next() = 0;

  /// The cells of the row.
  /// \throws FileError naming the file, row, column, what was found and what would be right, if the
  /// content is not of that kind. A number is finite, a flag is 0 or 1.
  [[nodiscard]] virtual std::string text(std::size_t column) const = 0;
  [[nodiscard]] virtual double number(std::size_t column) const = 0;
  [[nodiscard]] virtual long long integer(std::size_t column) const = 0;
  [[nodiscard]] virtual bool flag(std::size_t column) const = 0;
  /// The numbers in `column` and the two after it.
  [[nodiscard]] Eigen::Vector3d vector(std::size_t column) const {
    return {number(column), number(column + 1), number(column + 2)};
  }
};

}  // namespace palpate::probing
