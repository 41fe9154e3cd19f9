// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/mat_file.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <map>
#include <optional>
#include <utility>
#include <vector>

#include "palpate/core/module.h"
#include "palpate/probing/csv.h"
#include "records/mat_array.h"

namespace palpate::probing {

struct MatFile::Content {
  std::string path;
  std::map<std::string, MatArray> variables;
};

namespace {

const MatArrays& mat_arrays() {
  static const void* const arrays = module_symbol("mat_array");
  return *static_cast<const MatArrays*>(arrays);
}

/// "data.F(:,2)": the names data and F, and column 2.
struct MatColumnName {
  std::vector<std::string> names;
  enum class Part { whole, column, row } part = Part::whole;
  std::size_t index = 0;  ///< from 0
};

std::string without_blanks(std::string_view text) {
  std::string result;
  std::ranges::copy_if(text, std::back_inserter(result), [](char c) { return c != ' '; });
  return result;
}

/// The index of "2", counted from 0.
std::optional<std::size_t> index_from(std::string_view text) {
  std::size_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value == 0) return std::nullopt;
  return value - 1;
}

std::optional<MatColumnName> parse_name(std::string_view text) {
  const std::string plain = without_blanks(text);
  MatColumnName result;
  const std::size_t open = std::min(plain.find('('), plain.size());
  std::string_view path = std::string_view(plain).substr(0, open);
  for (bool more = true; more;) {
    const std::size_t dot = path.find('.');
    more = dot != std::string_view::npos;
    result.names.emplace_back(path.substr(0, dot));
    if (result.names.back().empty()) return std::nullopt;
    if (more) path.remove_prefix(dot + 1);
  }
  if (open == plain.size()) return result;
  std::string_view inside = std::string_view(plain).substr(open + 1);
  if (!inside.ends_with(')')) return std::nullopt;
  inside.remove_suffix(1);
  const bool is_column = inside.starts_with(":,");
  if (!is_column && !inside.ends_with(",:")) return std::nullopt;
  const auto index = index_from(is_column ? inside.substr(2) : inside.substr(0, inside.size() - 2));
  if (!index) return std::nullopt;
  result.part = is_column ? MatColumnName::Part::column : MatColumnName::Part::row;
  result.index = *index;
  return result;
}

std::optional<double> constant_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::string list_of_names(const std::map<std::string, MatArray>& arrays) {
  constexpr std::size_t kListed = 20;
  std::string list;
  std::size_t count = 0;
  for (const auto& [name, array] : arrays) {
    if (count++ == kListed) return list + ", ...";
    list += (list.empty() ? "" : ", ") + name;
  }
  return list.empty() ? "none" : list;
}

const char* words_for(const MatArray& array) {
  switch (array.kind) {
    case MAT_C_CELL:
      return "a cell array";
    case MAT_C_STRUCT:
      return "a structure";
    case MAT_C_CHAR:
      return "text";
    case MAT_C_SPARSE:
      return "sparse";
    default:
      return array.kind < MAT_C_DOUBLE || array.kind > MAT_C_UINT64 ? "an object" : "complex";
  }
}

bool is_real(const MatArray& array) {
  return array.kind >= MAT_C_DOUBLE && array.kind <= MAT_C_UINT64 && !array.complex;
}

std::string size_in_words(const MatArray& array) {
  std::string text;
  for (const std::size_t each : array.size)
    text += (text.empty() ? "" : " x ") + std::to_string(each);
  return text;
}

}  // namespace

struct MatReader::Columns {
  struct Source {
    std::string name;
    std::vector<double> numbers = {};
    std::optional<double> constant = std::nullopt;
    bool negated = false;
    bool row_number = false;
    [[nodiscard]] bool of_file() const { return !constant && !row_number && !name.empty(); }
  };

  const std::string* path = nullptr;
  const std::map<std::string, MatArray>* variables = nullptr;
  std::vector<std::string> asked;
  std::vector<Source> sources;
  std::size_t rows = 0, row = 0;  // `row` from 1 once there is one
  long long first_row = 1;

  [[noreturn]] void refuse(const std::string& name, const std::string& what) const {
    throw FileError(*path + ": " + name + " " + what);
  }

  /// The variable or field of this name; null if there is none.
  [[nodiscard]] const MatArray* find(const MatColumnName& name, const std::string& text) const {
    const std::map<std::string, MatArray>* fields = variables;
    const MatArray* array = nullptr;
    for (const std::string& each : name.names) {
      if (array != nullptr && (array->kind != MAT_C_STRUCT || array->fields.empty())) {
        refuse(text, array->kind == MAT_C_STRUCT
                         ? "is in an array of structures (" + size_in_words(*array) +
                               "); put the numbers of all into one matrix"
                         : std::string("is not in a structure: what stands before ." + each +
                                       " is no structure"));
      }
      if (array != nullptr) fields = &array->fields;
      const auto found = fields->find(each);
      if (found == fields->end()) return nullptr;
      array = &found->second;
    }
    return array;
  }

  [[nodiscard]] std::vector<double> numbers(const MatArray& array, const MatColumnName& name,
                                            const std::string& text) const {
    if (!is_real(array))
      refuse(text, std::string("is ") + words_for(array) + "; a column must be real numbers");
    if (array.size.size() != 2)
      refuse(text, "has the size " + size_in_words(array) + "; a column is part of a matrix");
    const std::size_t height = array.size[0], width = array.size[1];
    const std::vector<double>& all = array.numbers;
    if (name.part == MatColumnName::Part::whole) {
      if (height > 1 && width > 1) {
        const std::string& variable = name.names.back();
        refuse(text, "is a matrix of " + size_in_words(array) + "; name a column, such as " +
                         variable + "(:,1), or a row, such as " + variable + "(1,:)");
      }
      return all;
    }
    const bool is_column = name.part == MatColumnName::Part::column;
    if (name.index >= (is_column ? width : height)) {
      refuse(text, std::string("is not there: the matrix has ") +
                       std::to_string(is_column ? width : height) +
                       (is_column ? " columns" : " rows"));
    }
    std::vector<double> part;
    part.reserve(is_column ? height : width);
    for (std::size_t i = 0; i < (is_column ? height : width); ++i)
      part.push_back(is_column ? all[name.index * height + i] : all[i * height + name.index]);
    return part;
  }

  /// The meaning of a name; none if there is no such variable.
  [[nodiscard]] std::optional<Source> source_of(const std::string& text, bool renamed) const {
    if (renamed) {
      if (text.empty()) return Source{};
      if (text == kRowNumber && !variables->contains(text))
        return Source{.name = text, .row_number = true};
      if (const auto value = constant_number(text)) return Source{.name = text, .constant = value};
    }
    const bool negated = renamed && text.starts_with('-');
    const auto name = parse_name(negated ? text.substr(1) : text);
    if (!name) {
      throw FileError(*path + ": '" + text +
                      "' is no column; name one as F, F(:,2), F(2,:) or data.F(:,2)");
    }
    const MatArray* array = find(*name, text);
    if (array == nullptr) return std::nullopt;
    return Source{.name = text, .numbers = numbers(*array, *name, text), .negated = negated};
  }

  void take_column(const std::string& column, const TableLayout& layout) {
    const auto named = layout.names.find(column);
    const bool renamed = named != layout.names.end();
    const std::string& name = renamed ? named->second : column;
    std::optional<Source> source = source_of(name, renamed);
    const auto other = layout.defaults.find(column);
    if (!source && !renamed && other != layout.defaults.end())
      source = source_of(other->second, true);
    if (!source) {
      throw MissingColumn(*path + ": there is no variable '" + name + "'" +
                              (name != column ? " (for " + column + ")" : "") + "; the file has " +
                              list_of_names(*variables),
                          column);
    }
    asked.push_back(column);
    sources.push_back(*std::move(source));
  }

  void check_lengths() {
    const Source* first = nullptr;
    for (const Source& source : sources) {
      if (!source.of_file()) continue;
      if (first == nullptr) first = &source;
      if (source.numbers.size() == first->numbers.size()) continue;
      refuse(source.name, "has " + std::to_string(source.numbers.size()) + " rows and " +
                              first->name + " has " + std::to_string(first->numbers.size()) +
                              "; all columns of a table must have the same number");
    }
    if (first == nullptr) throw FileError(*path + ": no column is read from the file");
    rows = first->numbers.size();
  }

  [[nodiscard]] double value(std::size_t column) const {
    const Source& source = sources[column];
    if (source.row_number) return static_cast<double>(first_row) + static_cast<double>(row - 1);
    if (source.constant) return *source.constant;
    if (!source.of_file()) refuse_cell(column, "nothing", "a number");
    const double number = source.numbers[row - 1];
    return source.negated ? -number : number;
  }

  [[noreturn]] void refuse_cell(std::size_t column, const std::string& found,
                                const std::string& right) const {
    const Source& source = sources[column];
    throw FileError(*path + ": " + (source.of_file() ? source.name + " (" : "") + asked[column] +
                    (source.of_file() ? ")" : "") + ", row " + std::to_string(row) + ": found " +
                    found + ", expected " + right);
  }
};

MatFile::MatFile(const std::filesystem::path& path)
    : content_(std::make_unique<const Content>(Content{path.string(), mat_arrays().read(path)})) {}
MatFile::~MatFile() = default;
MatFile::MatFile(MatFile&&) noexcept = default;
MatFile& MatFile::operator=(MatFile&&) noexcept = default;

MatReader::MatReader(const MatFile& file, std::span<const std::string_view> columns,
                     const TableLayout& layout)
    : columns_(std::make_unique<Columns>()) {
  columns_->path = &file.content_->path;
  columns_->variables = &file.content_->variables;
  columns_->first_row = layout.first_row;
  for (const std::string_view column : columns) columns_->take_column(std::string(column), layout);
  columns_->check_lengths();
}
MatReader::~MatReader() = default;

bool MatReader::next() {
  if (columns_->row == columns_->rows) return false;
  ++columns_->row;
  return true;
}

double MatReader::number(std::size_t column) const {
  const double value = columns_->value(column);
  if (!std::isfinite(value)) {
    columns_->refuse_cell(column, std::isnan(value) ? "NaN" : "Inf",
                          "a finite number; leave the row out");
  }
  return value;
}

std::string MatReader::text(std::size_t column) const {
  const Columns::Source& source = columns_->sources[column];
  return source.of_file() || source.row_number ? to_text(columns_->value(column)) : source.name;
}

long long MatReader::integer(std::size_t column) const {
  const double value = number(column);
  constexpr double kExact = 9007199254740992;  // 2^53: larger doubles skip whole numbers
  if (value != std::floor(value) || std::abs(value) > kExact)
    columns_->refuse_cell(column, to_text(value), "a whole number such as 12");
  return static_cast<long long>(value);
}

bool MatReader::flag(std::size_t column) const {
  const double value = number(column);
  if (value != 0 && value != 1) columns_->refuse_cell(column, to_text(value), "0 or 1");
  return value == 1;
}

}  // namespace palpate::probing
