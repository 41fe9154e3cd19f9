// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iosfwd>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "palpate/eigen_alignment.h"
#include "palpate/error.h"

namespace palpate::probing {

/// How a CSV file of another program differs.
struct CsvLayout {
  /// Between cells. Default: the most frequent of comma, semicolon and tab in the first line.
  std::optional<char> separator = std::nullopt;
  /// The names that columns have in the file, by the names that they are asked for. Text that names
  /// no column of the file, but is a number or empty, is the content of all cells.
  std::map<std::string, std::string, std::less<>> names = {};
};

/// A CSV file without a column that is asked for.
struct MissingColumn : FileError {
  MissingColumn(const std::string& message, std::string column)
      : FileError(message), name(std::move(column)) {}
  std::string name;  ///< as it is asked for
};

/// Reads a CSV file row by row, so that only one line is in memory however long the file is. The
/// first line of the file names its columns.
///
/// Columns may stand in any order, and those that were not asked for are ignored. Cells are
/// separated as the layout says and may be quoted ("" is a quote). Lines end with \n or \r\n; the
/// last one may lack its end. Blank lines are skipped. Every message names the file, line, column,
/// the text found and what would be right.
class CsvReader {
 public:
  /// \throws FileError if the file is missing or empty, or if one of `columns` is named twice;
  /// MissingColumn if it is missing.
  CsvReader(const std::filesystem::path& path, std::span<const std::string_view> columns,
            const CsvLayout& layout = {});
  CsvReader(const CsvReader&) = delete;  // its cells point into its line
  CsvReader& operator=(const CsvReader&) = delete;

  /// Moves to the first row, and from each row to the next one. False if there is none.
  ///
  /// \throws FileError if the line has more or fewer cells than the first line of the file.
  [[nodiscard]] bool next();
  /// The line of the row in the file, counted from 1.
  [[nodiscard]] std::size_t line() const { return line_; }

  /// The cells of the row; `column` is an index into the constructor's `columns`.
  ///
  /// \throws FileError if the text is not of that kind. A number is finite, a flag is 0 or 1.
  [[nodiscard]] std::string text(std::size_t column) const;
  [[nodiscard]] double number(std::size_t column) const;
  /// The numbers in `column` and the two after it.
  [[nodiscard]] Eigen::Vector3d vector(std::size_t column) const;
  [[nodiscard]] long long integer(std::size_t column) const;
  [[nodiscard]] bool flag(std::size_t column) const;

 private:
  [[nodiscard]] bool next_line();
  [[nodiscard]] std::string place() const;
  [[noreturn]] void refuse(std::size_t column, std::string_view right) const;
  [[nodiscard]] std::string_view cell(std::size_t column) const;
  void find_columns();

  std::filesystem::path path_;
  std::ifstream file_;
  std::vector<std::string> columns_;                // as they are asked for
  std::vector<std::string> names_;                  // in the file, or what all their cells hold
  std::vector<std::optional<std::size_t>> places_;  // in the header line
  char separator_ = '\0';                           // '\0': not known before the first line
  std::size_t width_ = 0;                           // cells of the header line
  std::size_t line_ = 0;
  std::string text_;                     // of the line; quoted cells without their quotes
  std::vector<std::string_view> cells_;  // of the line, in `text_`
};

/// Writes the header line.
void write_csv_header(std::ostream& out, std::span<const std::string_view> columns);

/// A number in its shortest decimal form that reads back exactly.
[[nodiscard]] std::string to_text(double value);
[[nodiscard]] std::string to_text(long long value);

/// A cell of text, quoted where needed.
///
/// \throws InvalidInput if the text holds a line break, which a cell cannot hold.
[[nodiscard]] std::string to_cell(const std::string& text);

}  // namespace palpate::probing
