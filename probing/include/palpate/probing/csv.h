// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iosfwd>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/probing/table_reader.h"

namespace palpate::probing {

/// Reads a CSV file row by row, so that only one line is in memory however long the file is. The
/// first line of the file names its columns, unless the layout says that there is no such line.
///
/// Columns may stand in any order, and those that were not asked for are ignored. Cells are
/// separated as the layout says and may be quoted ("" is a quote). Lines end with \n or \r\n; the
/// last one may lack its end. Blank lines are skipped. Every message names the file, line, column,
/// the text found and what would be right.
class CsvReader final : public TableReader {
 public:
  /// \throws FileError if the file is missing, empty or no text, or if one of `columns` is named
  /// twice; MissingColumn if it is missing.
  CsvReader(const std::filesystem::path& path, std::span<const std::string_view> columns,
            const TableLayout& layout = {});

  /// \throws FileError if the line has more or fewer cells than the first line of the file.
  [[nodiscard]] bool next() override;
  /// The line of the row in the file, counted from 1.
  [[nodiscard]] std::size_t line() const { return line_; }

  [[nodiscard]] std::string text(std::size_t column) const override;
  [[nodiscard]] double number(std::size_t column) const override;
  [[nodiscard]] long long integer(std::size_t column) const override;
  [[nodiscard]] bool flag(std::size_t column) const override;

 private:
  void check_text();
  [[nodiscard]] bool next_line();
  [[nodiscard]] std::string place() const;
  [[noreturn]] void refuse(std::size_t column, std::string_view right) const;
  [[nodiscard]] std::string_view cell(std::size_t column) const;
  void find_columns(const TableLayout& layout);

  std::filesystem::path path_;
  std::ifstream file_;
  // The source of a column.
  struct Source {
    std::string name;                                 // in the file, or what all its cells hold
    std::optional<std::size_t> place = std::nullopt;  // in the header line
    bool negated = false;
    bool row_number = false;
  };
  [[nodiscard]] std::optional<Source> find_source(const std::string& name, bool renamed) const;
  [[nodiscard]] std::optional<std::size_t> place_of(std::string_view name) const;
  [[noreturn]] void refuse_columns(const std::string& column, const std::string& name) const;

  std::vector<std::string> columns_;  // as they are asked for
  std::vector<Source> sources_;
  std::string row_;  // number of the row
  long long row_number_ = 0;
  char separator_ = '\0';  // '\0': not known before the first line
  bool header_ = true;
  bool decimal_comma_ = false;
  bool mapped_ = false;
  bool kept_ = false;      // the first line is a row, which `next` has still to deliver
  std::size_t width_ = 0;  // cells of the header line
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
