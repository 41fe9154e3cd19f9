// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/csv.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <optional>
#include <ostream>
#include <utility>

#include "palpate/core/error.h"
#include "records/file_kind.h"

namespace palpate::probing {
namespace {

constexpr std::string_view kColumnNumber = "column_";  // before the number of a column, from 1
constexpr std::string_view kNoMinus = "the name of the column without a minus sign";
constexpr std::size_t kShownLength = 40;  // characters of a wrong cell that a message repeats

std::string shown(std::string_view text) {
  std::string result = "'";
  for (const char c : text.substr(0, kShownLength)) {
    const bool printable = c >= ' ' && c <= '~';
    result += printable ? c : '?';
  }
  return result + (text.size() > kShownLength ? "...'" : "'");
}

// Splits a line into cells, in place; quoted cells lose their quotes. Returns false if a quote is
// not closed or stands inside a cell.
bool split(std::string& line, char separator, std::vector<std::string_view>& cells) {
  cells.clear();
  const std::size_t size = line.size();
  for (std::size_t i = 0;; ++i) {
    const std::size_t begin = i;
    if (i == size || line[i] != '"') {
      i = std::min(line.find(separator, i), size);
      cells.emplace_back(line.data() + begin, i - begin);
    } else {
      std::size_t end = begin;
      for (++i;; ++i) {
        if (i == size) return false;
        if (line[i] == '"' && (++i == size || line[i] != '"')) break;
        line[end++] = line[i];
      }
      if (i < size && line[i] != separator) return false;
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

// The most frequent of the separators outside quotes; the first of them if there is none.
char separator_in(std::string_view line, bool decimal_comma) {
  const std::string_view separators = decimal_comma ? ";\t" : ",;\t";
  std::array<int, 3> counts{};
  bool quoted = false;
  for (const char c : line) {
    quoted = quoted != (c == '"');
    const std::size_t which = separators.find(c);
    if (!quoted && which != std::string_view::npos) ++counts[which];
  }
  return separators[static_cast<std::size_t>(std::ranges::max_element(counts) - counts.begin())];
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

bool has_decimal_comma(std::string_view text) {
  if (text.find(',') == std::string_view::npos) return false;
  std::string pointed(text);
  std::ranges::replace(pointed, ',', '.');
  return parse<double>(pointed).has_value();
}

// Such as 1,234.5 or 1'234: a number once these characters are out.
bool has_thousands(std::string_view text) {
  constexpr std::string_view kBetween = ",.' _";
  std::string digits;
  for (const char c : trimmed(text))
    if (kBetween.find(c) == std::string_view::npos) digits += c;
  return digits.size() < trimmed(text).size() && parse<double>(digits).has_value();
}

// The correct content in place of a cell that is no number.
std::string_view right_number(std::string_view cell, bool decimal_comma) {
  if (!decimal_comma && has_decimal_comma(cell)) return "a decimal point in place of the comma";
  if (has_thousands(cell)) {
    return decimal_comma
               ? "a finite number with a decimal comma, without signs between the thousands"
               : "a finite number with a decimal point, without signs between the thousands";
  }
  return decimal_comma ? "a finite number such as -1,5" : "a finite number such as -1.5e-3";
}

// Returns true if a column seems to be the one with this name: with a unit, or in other letters.
bool is_like(std::string_view cell, std::string_view name) {
  const std::string_view found =
      trimmed(trimmed(cell).substr(0, trimmed(cell).find_first_of("([")));
  const auto same = [](char a, char b) {
    return std::tolower(static_cast<unsigned char>(a)) ==
           std::tolower(static_cast<unsigned char>(b));
  };
  return !found.empty() && std::ranges::equal(found, name, same);
}

constexpr const char* kSayNoHeader =
    "if the file has no line of names, say so (--no-header, or header: false in a mapping) and "
    "name its columns column_1, column_2, ...";

bool has_numbers_only(const std::vector<std::string_view>& cells) {
  return std::all_of(cells.begin(), cells.end(),
                     [](std::string_view cell) { return parse<double>(cell).has_value(); });
}

template <typename T>
std::string shortest(T value) {
  char buffer[32];  // the longest double has 24 characters, the longest 64-bit integer 20
  return {buffer, std::to_chars(buffer, buffer + sizeof buffer, value).ptr};
}

}  // namespace

CsvReader::CsvReader(const std::filesystem::path& path, std::span<const std::string_view> columns,
                     const TableLayout& layout)
    : path_(path), columns_(columns.begin(), columns.end()), row_number_(layout.first_row - 1) {
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) {
    const bool is_folder = std::filesystem::is_directory(path, error);
    throw FileError(path.string() + (is_folder ? ": is a folder" : ": there is no such file") +
                    "; expected a CSV file");
  }
  file_.open(path, std::ios::binary);
  if (!file_) throw FileError(path.string() + ": cannot be read");
  check_text();
  separator_ = layout.separator.value_or('\0');
  header_ = layout.header;
  decimal_comma_ = layout.decimal_comma;
  mapped_ = layout.mapped;
  if (!next_line()) {
    throw FileError(path.string() + ": the file is empty; the first line must name the columns " +
                    joined(columns));
  }
  find_columns(layout);
  width_ = cells_.size();
  kept_ = !header_;
}

// A file of another kind is better named than read.
void CsvReader::check_text() {
  std::array<char, kFileStart> start{};
  file_.read(start.data(), start.size());
  const std::string_view found(start.data(), static_cast<std::size_t>(file_.gcount()));
  if (const std::optional<std::string_view> kind = other_than_text(found))
    throw FileError(path_.string() + ": is " + std::string(*kind));
  file_.clear();
  file_.seekg(0);
}

std::optional<std::size_t> CsvReader::place_of(std::string_view name) const {
  if (header_) {
    const auto is_it = [&](std::string_view cell) { return trimmed(cell) == name; };
    const auto found = std::find_if(cells_.begin(), cells_.end(), is_it);
    if (found != cells_.end()) {
      if (std::find_if(found + 1, cells_.end(), is_it) != cells_.end()) {
        throw FileError(place() + ": column '" + std::string(name) +
                        "' is there twice; keep one, or name it by its number, such as " +
                        std::string(kColumnNumber) + std::to_string(found - cells_.begin() + 1));
      }
      return static_cast<std::size_t>(found - cells_.begin());
    }
  }
  if (!name.starts_with(kColumnNumber)) return std::nullopt;
  const std::optional<std::size_t> number = parse<std::size_t>(name.substr(kColumnNumber.size()));
  if (!number || *number == 0 || *number > cells_.size()) return std::nullopt;
  if (header_ && has_numbers_only(cells_)) {
    throw FileError(place() + ": holds numbers only, but is taken as the names of the columns; " +
                    kSayNoHeader);
  }
  return *number - 1;
}

// The column of the header line, or what stands for a column, with this name.
std::optional<CsvReader::Source> CsvReader::find_source(const std::string& name,
                                                        bool renamed) const {
  if (const auto place = place_of(name)) return Source{name, place};
  if (!renamed) return std::nullopt;
  if (name.empty() || parse<double>(name)) return Source{name};
  if (name == kRowNumber) return Source{.name = name, .row_number = true};
  if (name.starts_with('-')) {
    const std::string positive = name.substr(1);
    if (const auto place = place_of(positive))
      return Source{.name = positive, .place = place, .negated = true};
  }
  return std::nullopt;
}

// Finds the position of each wanted column in the first line, which was just read.
void CsvReader::find_columns(const TableLayout& layout) {
  for (const std::string& column : columns_) {
    const auto named = layout.names.find(column);
    const bool renamed = named != layout.names.end();
    const std::string& name = renamed ? named->second : column;
    std::optional<Source> source = find_source(name, renamed);
    const auto other = layout.defaults.find(column);
    if (!source && !renamed && other != layout.defaults.end())
      source = find_source(other->second, true);
    if (!source) refuse_columns(column, name);
    sources_.push_back(*std::move(source));
  }
}

// Says why the first line does not have a column, and which it has.
void CsvReader::refuse_columns(const std::string& column, const std::string& name) const {
  const std::vector<std::string_view> wanted(columns_.begin(), columns_.end());
  if (cells_.size() == 1 && columns_.size() > 1) {
    throw FileError(place() + ": is one cell, " + shown(cells_.front()) +
                    "; it must name the columns " + joined(wanted) +
                    (mapped_ ? ". Give the separator that is between them"
                             : ", separated by commas, semicolons or tabs"));
  }
  const std::string whose = name != column ? " (for " + column + ")" : "";
  if (!header_) {
    throw MissingColumn(place() + ": there is no column '" + name + "'" + whose +
                            "; without a header line, columns are named by their numbers, from " +
                            std::string(kColumnNumber) + "1 to " + std::string(kColumnNumber) +
                            std::to_string(cells_.size()),
                        column);
  }
  if (has_numbers_only(cells_)) {
    throw MissingColumn(place() + ": there is no column '" + name + "'" + whose +
                            ": the line holds numbers only; " +
                            (mapped_ ? kSayNoHeader : "the first line must name the columns"),
                        column);
  }
  const auto like = std::find_if(cells_.begin(), cells_.end(),
                                 [&](std::string_view cell) { return is_like(cell, name); });
  throw MissingColumn(place() + ": there is no column '" + name + "'" + whose +
                          (like == cells_.end() ? "" : ", but " + shown(trimmed(*like))) +
                          "; the first line must name the columns " + joined(wanted) +
                          ", and it names " + shown(joined(cells_)),
                      column);
}

std::string_view CsvReader::cell(std::size_t column) const {
  const Source& source = sources_[column];
  if (source.place) return cells_[*source.place];
  return source.row_number ? row_ : source.name;
}

bool CsvReader::next() {
  if (!std::exchange(kept_, false) && !next_line()) return false;
  row_ = to_text(++row_number_);
  if (cells_.size() == width_) return true;
  throw FileError(place() + ": " + std::to_string(cells_.size()) + " cells, the first line " +
                  (header_ ? "names " : "has ") + std::to_string(width_) +
                  " columns; the line is cut off or has a separator too many");
}

// The cells of the next line that is not blank.
bool CsvReader::next_line() {
  while (std::getline(file_, text_)) {
    constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
    if (++line_ == 1 && text_.starts_with(kByteOrderMark)) text_.erase(0, kByteOrderMark.size());
    if (text_.ends_with('\r')) text_.pop_back();
    if (trimmed(text_).empty()) continue;
    if (separator_ == '\0') separator_ = separator_in(text_, decimal_comma_);
    if (!split(text_, separator_, cells_))
      throw FileError(place() + ": a quote is not closed or stands inside a cell");
    return true;
  }
  if (file_.bad()) throw FileError(path_.string() + ": cannot be read");
  return false;
}

std::string CsvReader::place() const { return path_.string() + ": line " + std::to_string(line_); }

std::string CsvReader::text(std::size_t column) const { return std::string(cell(column)); }

double CsvReader::number(std::size_t column) const {
  const std::string_view text = cell(column);
  std::optional<double> value;
  if (!decimal_comma_ || !sources_[column].place) {
    value = parse<double>(text);
  } else if (text.find('.') == std::string_view::npos) {
    std::string pointed(text);
    std::ranges::replace(pointed, ',', '.');
    value = parse<double>(pointed);
  }
  if (!value || !std::isfinite(*value)) {
    std::string right(right_number(text, decimal_comma_));
    if (mapped_ && !decimal_comma_ && has_decimal_comma(text))
      right +=
          "; or say that numbers have a decimal comma (--decimal comma, or decimal: comma in "
          "a mapping)";
    refuse(column, right);
  }
  return sources_[column].negated ? -*value : *value;
}

long long CsvReader::integer(std::size_t column) const {
  if (sources_[column].negated) refuse(column, kNoMinus);
  const std::optional<long long> value = parse<long long>(cell(column));
  if (!value) refuse(column, "a whole number such as 12");
  return *value;
}

bool CsvReader::flag(std::size_t column) const {
  if (sources_[column].negated) refuse(column, kNoMinus);
  const std::string_view value = trimmed(cell(column));
  if (value != "0" && value != "1") refuse(column, "0 or 1");
  return value == "1";
}

void CsvReader::refuse(std::size_t column, std::string_view right) const {
  const std::string& name = sources_[column].place ? sources_[column].name : columns_[column];
  throw FileError(place() + ", column '" + name + "': found " + shown(cell(column)) +
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
