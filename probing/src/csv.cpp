// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <iterator>
#include <optional>
#include <ostream>

#include "palpate/error.h"

namespace palpate::probing {
namespace {

constexpr std::size_t kShownLength = 40;  // characters of a wrong cell that a message repeats

std::string shown(std::string_view text) {
  std::string result = "'";
  for (const char c : text.substr(0, kShownLength)) {
    const bool printable = c >= ' ' && c <= '~';
    result += printable ? c : '?';
  }
  return result + (text.size() > kShownLength ? "...'" : "'");
}

std::string read_text(const std::filesystem::path& path) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw FileError(path.string() + ": there is no such file; expected a CSV file");
  }
  std::ifstream in(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  if (!in.good() && !in.eof()) throw FileError(path.string() + ": cannot be read");
  constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
  if (text.starts_with(kByteOrderMark)) text.erase(0, kByteOrderMark.size());
  return text;
}

// Cells of one line; none if a quote is not closed or stands inside a cell.
std::optional<std::vector<std::string>> split(std::string_view line) {
  std::vector<std::string> cells(1);
  for (std::size_t i = 0; i < line.size();) {
    if (line[i] == '"' && cells.back().empty()) {
      for (++i;; ++i) {
        if (i == line.size()) return std::nullopt;
        if (line[i] == '"' && (++i == line.size() || line[i] != '"')) break;
        cells.back() += line[i];
      }
      if (i < line.size() && line[i] != ',') return std::nullopt;
    } else if (line[i] == ',') {
      cells.emplace_back();
      ++i;
    } else {
      cells.back() += line[i++];
    }
  }
  return cells;
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kBlank = " \t";
  const std::size_t first = text.find_first_not_of(kBlank);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(kBlank) - first + 1);
}

std::string joined(std::span<const std::string_view> columns) {
  std::string result;
  for (const std::string_view column : columns) {
    if (!result.empty()) result += ',';
    result += column;
  }
  return result;
}

// Where each wanted column stands in the header line.
std::vector<std::size_t> find_columns(const std::string& place,
                                      const std::vector<std::string>& header,
                                      std::span<const std::string_view> columns) {
  std::vector<std::size_t> result;
  for (const std::string_view column : columns) {
    const auto is_it = [&](const std::string& cell) { return trimmed(cell) == column; };
    const auto found = std::find_if(header.begin(), header.end(), is_it);
    if (found == header.end()) {
      throw FileError(place + ": there is no column '" + std::string(column) +
                      "'; the first line must name the columns " + joined(columns));
    }
    if (std::find_if(found + 1, header.end(), is_it) != header.end()) {
      throw FileError(place + ": column '" + std::string(column) + "' is there twice; keep one");
    }
    result.push_back(static_cast<std::size_t>(found - header.begin()));
  }
  return result;
}

// The whole text as a T, or none.
template <typename T>
std::optional<T> parse(std::string_view text) {
  text = trimmed(text);
  if (text.starts_with('+') && !text.starts_with("+-")) text.remove_prefix(1);
  T value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

template <typename T>
std::string shortest(T value) {
  char buffer[32];  // the longest double has 24 characters, the longest 64-bit integer 20
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

}  // namespace

CsvTable::CsvTable(const std::filesystem::path& path, std::span<const std::string_view> columns)
    : path_(path), columns_(columns.begin(), columns.end()) {
  const std::string content = read_text(path);
  std::vector<std::size_t> places;
  std::size_t width = 0, number = 0;
  for (std::size_t start = 0; start < content.size();) {
    const std::size_t end = std::min(content.find('\n', start), content.size());
    std::string_view line(content.data() + start, end - start);
    start = end + 1;
    ++number;
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (trimmed(line).empty()) continue;
    const std::string place = path.string() + ": line " + std::to_string(number);
    std::optional<std::vector<std::string>> cells = split(line);
    if (!cells) throw FileError(place + ": a quote is not closed or stands inside a cell");
    if (places.empty()) {
      places = find_columns(place, *cells, columns);
      width = cells->size();
      continue;
    }
    if (cells->size() != width) {
      throw FileError(place + ": " + std::to_string(cells->size()) +
                      " cells, the first line names " + std::to_string(width) +
                      " columns; the line is cut off or has a comma too many");
    }
    lines_.push_back(number);
    for (const std::size_t at : places) cells_.push_back(std::move((*cells)[at]));
  }
  if (places.empty()) {
    throw FileError(path.string() + ": the file is empty; the first line must name the columns " +
                    joined(columns));
  }
}

const std::string& CsvTable::text(std::size_t row, std::size_t column) const {
  return cells_[row * columns_.size() + column];
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  const std::optional<double> value = parse<double>(text(row, column));
  if (!value || !std::isfinite(*value)) refuse(row, column, "a finite number such as -1.5e-3");
  return *value;
}

long long CsvTable::integer(std::size_t row, std::size_t column) const {
  const std::optional<long long> value = parse<long long>(text(row, column));
  if (!value) refuse(row, column, "a whole number such as 12");
  return *value;
}

bool CsvTable::flag(std::size_t row, std::size_t column) const {
  const std::string_view value = trimmed(text(row, column));
  if (value != "0" && value != "1") refuse(row, column, "0 or 1");
  return value == "1";
}

void CsvTable::refuse(std::size_t row, std::size_t column, std::string_view right) const {
  throw FileError(path_.string() + ": line " + std::to_string(line(row)) + ", column '" +
                  columns_[column] + "': found " + shown(text(row, column)) + ", expected " +
                  std::string(right));
}

void write_csv_header(std::ostream& out, std::span<const std::string_view> columns) {
  out << joined(columns) << '\n';
}

std::string to_text(double value) { return shortest(value); }
std::string to_text(long long value) { return shortest(value); }

std::string to_cell(const std::string& text) {
  if (text.find_first_of("\r\n") != std::string::npos) {
    throw InvalidInput("the text " + shown(text) + " holds a line break; a CSV cell cannot");
  }
  const bool plain = text.find_first_of(",\"") == std::string::npos && trimmed(text) == text;
  if (plain) return text;
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"') result += '"';
    result += c;
  }
  return result + '"';
}

}  // namespace palpate::probing
