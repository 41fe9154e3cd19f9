// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::probing {

/// A CSV file whose first line names the columns.
///
/// Columns may stand in any order; those that nobody asked for are ignored. Cells are separated by
/// commas and may be quoted ("" is a quote). Lines end with \n or \r\n, the last one may end
/// without; blank lines are skipped. Every message names file, line, column, the text found and
/// what is right.
class CsvTable {
 public:
  /// \throws FileError if the file is missing or empty, one of `columns` is missing or named twice,
  /// or a line has more or fewer cells than the first.
  CsvTable(const std::filesystem::path& path, std::span<const std::string_view> columns);

  [[nodiscard]] std::size_t rows() const { return lines_.size(); }
  /// Line in the file, from 1.
  [[nodiscard]] std::size_t line(std::size_t row) const { return lines_[row]; }

  /// Cells; `column` is the index in the constructor's `columns`.
  /// \throws FileError if the text is not of that kind (number: finite; flag: 0 or 1).
  [[nodiscard]] const std::string& text(std::size_t row, std::size_t column) const;
  [[nodiscard]] double number(std::size_t row, std::size_t column) const;
  [[nodiscard]] long long integer(std::size_t row, std::size_t column) const;
  [[nodiscard]] bool flag(std::size_t row, std::size_t column) const;

 private:
  [[noreturn]] void refuse(std::size_t row, std::size_t column, std::string_view right) const;

  std::filesystem::path path_;
  std::vector<std::string> columns_;
  std::vector<std::size_t> lines_;
  std::vector<std::string> cells_;  // rows x columns_
};

/// Writes the header line.
void write_csv_header(std::ostream& out, std::span<const std::string_view> columns);

/// The shortest decimal form that reads back to the same number, and an integer.
[[nodiscard]] std::string to_text(double value);
[[nodiscard]] std::string to_text(long long value);

/// A cell of text, quoted where needed.
/// \throws InvalidInput if it holds a line break, which this format has no place for.
[[nodiscard]] std::string to_cell(const std::string& text);

}  // namespace palpate::probing
