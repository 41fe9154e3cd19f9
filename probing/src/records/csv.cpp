// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/csv.h"

#include <algorithm>
#include <charconv>
#include <cmath>
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

// The cells of a line, where they stand in it but for quoted ones, which lose their quotes in
// place; false if a quote is not closed or stands inside a cell.
bool split(std::string& line, std::vector<std::string_view>& cells) {
  cells.clear();
  const std::size_t size = line.size();
  for (std::size_t i = 0;; ++i) {
    const std::size_t begin = i;
    if (i == size || line[i] != '"') {
      i = std::min(line.find(',', i), size);
      cells.emplace_back(line.data() + begin, i - begin);
    } else {
      std::size_t end = begin;
      for (++i;; ++i) {
        if (i == size) return false;
        if (line[i] == '"' && (++i == size || line[i] != '"')) break;
        line[end++] = line[i];
      }
      if (i < size && line[i] != ',') return false;
      cells.emplace_back(line.data() + begin, end - begin);
    }
    if (i == size) return true;
  }
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
                                      const std::vector<std::string_view>& header,
                                      std::span<const std::string_view> columns) {
  std::vector<std::size_t> result;
  for (const std::string_view column : columns) {
    const auto is_it = [&](std::string_view cell) { return trimmed(cell) == column; };
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

CsvReader::CsvReader(const std::filesystem::path& path, std::span<const std::string_view> columns)
    : path_(path), columns_(columns.begin(), columns.end()) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    throw FileError(path.string() + ": there is no such file; expected a CSV file");
  }
  file_.open(path, std::ios::binary);
  if (!file_) throw FileError(path.string() + ": cannot be read");
  if (!next_line()) {
    throw FileError(path.string() + ": the file is empty; the first line must name the columns " +
                    joined(columns));
  }
  places_ = find_columns(place(), cells_, columns);
  width_ = cells_.size();
}

bool CsvReader::next() {
  if (!next_line()) return false;
  if (cells_.size() == width_) return true;
  throw FileError(place() + ": " + std::to_string(cells_.size()) + " cells, the first line names " +
                  std::to_string(width_) + " columns; the line is cut off or has a comma too many");
}

// The cells of the next line that is not blank.
bool CsvReader::next_line() {
  while (std::getline(file_, text_)) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (++line_ == 1 && text_.starts_with(kByteOrderMark)) text_.erase(0, kByteOrderMark.size());
    if (text_.ends_with('\r')) text_.pop_back();
    if (trimmed(text_).empty()) continue;
    if (!split(text_, cells_))
      throw FileError(place() + ": a quote is not closed or stands inside a cell");
    return true;
  }
  if (file_.bad()) throw FileError(path_.string() + ": cannot be read");
  return false;
}

std::string CsvReader::place() const { return path_.string() + ": line " + std::to_string(line_); }

std::string CsvReader::text(std::size_t column) const { return std::string(cell(column)); }

double CsvReader::number(std::size_t column) const {
  const std::optional<double> value = parse<double>(cell(column));
  if (!value || !std::isfinite(*value)) refuse(column, "a finite number such as -1.5e-3");
  return *value;
}

Eigen::Vector3d CsvReader::vector(std::size_t column) const {
  return {number(column), number(column + 1), number(column + 2)};
}

long long CsvReader::integer(std::size_t column) const {
  const std::optional<long long> value = parse<long long>(cell(column));
  if (!value) refuse(column, "a whole number such as 12");
  return *value;
}

bool CsvReader::flag(std::size_t column) const {
  const std::string_view value = trimmed(cell(column));
  if (value != "0" && value != "1") refuse(column, "0 or 1");
  return value == "1";
}

void CsvReader::refuse(std::size_t column, std::string_view right) const {
  throw FileError(place() + ", column '" + columns_[column] + "': found " + shown(cell(column)) +
                  ", expected " + std::string(right));
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
