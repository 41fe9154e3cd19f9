// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/field_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"

namespace palpate {
namespace {

class TextWriter : public FieldVisitor {
 public:
  std::vector<FieldText> texts;

  void begin(std::string_view type) override { type_ = type; }

 private:
  void on_real(const Field& field, const NumberField<double>& value) override {
    add(field, value.value ? fmt::format("{}", *value.value) : "", to_string(value.range));
  }
  void on_whole(const Field& field, const NumberField<int>& value) override {
    add(field, value.value ? fmt::format("{}", *value.value) : "", to_string(value.range));
  }
  void on_flag(const Field& field, bool value, const std::function<void(bool)>& /*set*/) override {
    add(field, value ? "true" : "false");
    texts.back().is_flag = true;
  }
  void on_choice(const Field& field, const ChoiceField& value) override {
    add(field, std::string(value.words[value.value]));
  }
  void on_table(const Field& field, const TableField& value) override {
    std::vector<std::string> lines;
    for (const std::vector<double>& row : value.value)
      lines.push_back(fmt::format("{}", fmt::join(row, ",")));
    add(field, fmt::format("{}", fmt::join(lines, ";")));
  }

  void add(const Field& field, std::string text, std::string range = {}) {
    texts.push_back({type_, std::string(field.name), std::string(field.option),
                     std::string(field.unit), std::move(range), std::move(text)});
  }

  std::string type_;
};

std::vector<std::string_view> split(std::string_view text, char separator) {
  std::vector<std::string_view> parts;
  for (;;) {
    const std::size_t end = text.find(separator);
    parts.push_back(text.substr(0, end));
    if (end == std::string_view::npos) return parts;
    text.remove_prefix(end + 1);
  }
}

/// Sets the field that has a given name.
class TextReader : public FieldVisitor {
 public:
  TextReader(std::string_view name, std::string_view text) : name_(name), text_(text) {}

  bool is_found = false;
  std::string type;
  std::vector<std::string> names;

  void begin(std::string_view the_type) override { type = the_type; }

 private:
  void on_real(const Field& field, const NumberField<double>& value) override {
    if (!is_named(field) || is_left_out(value)) return;
    value.set(number<double>(text_, value.range, "a number"));
  }
  void on_whole(const Field& field, const NumberField<int>& value) override {
    if (!is_named(field) || is_left_out(value)) return;
    value.set(number<int>(text_, value.range, "a whole number"));
  }
  void on_flag(const Field& field, bool /*value*/, const std::function<void(bool)>& set) override {
    if (!is_named(field)) return;
    if (text_ != "true" && text_ != "false") refuse("true or false");
    set(text_ == "true");
  }
  void on_choice(const Field& field, const ChoiceField& value) override {
    if (!is_named(field)) return;
    const auto found = std::ranges::find(value.words, text_);
    if (found == value.words.end()) refuse(fmt::format("{}", fmt::join(value.words, " or ")));
    value.set(static_cast<std::size_t>(found - value.words.begin()));
  }
  void on_table(const Field& field, const TableField& value) override {
    if (!is_named(field)) return;
    const std::size_t width = value.columns.size();
    TableField::Rows rows;
    for (const std::string_view line : split(text_, ';')) {
      if (line.empty()) continue;
      const std::vector<std::string_view> words = split(line, ',');
      if (words.size() != width)
        refuse(fmt::format("rows of {} numbers, such as 1,2;3,4 of two", width));
      std::vector<double>& row = rows.emplace_back();
      for (std::size_t i = 0; i < width; ++i)
        row.push_back(number<double>(words[i], value.columns[i].range, "numbers"));
    }
    value.set(rows);
  }

  bool is_named(const Field& field) {
    names.emplace_back(field.name);
    if (field.name != name_) return false;
    is_found = true;
    return true;
  }

  bool is_left_out(const auto& value) const {
    if (!text_.empty() || !value.may_be_absent) return false;
    value.set(std::nullopt);
    return true;
  }

  template <typename Number>
  Number number(std::string_view text, const Interval& range, const char* kind) const {
    const std::optional<Number> value = parse_number<Number>(text);
    if (!value || !range.contains(*value)) refuse(fmt::format("{} {}", kind, to_string(range)));
    return *value;
  }

  [[noreturn]] void refuse(const std::string& right) const {
    throw InvalidInput(
        std::vector<MessagePart>{{type + "::" + std::string(name_), true},
                                 {fmt::format(" is {}; it must be {}", quoted(text_), right)}});
  }

  std::string_view name_, text_;
};

}  // namespace

std::vector<FieldText> texts_of(const FieldList& fields) {
  TextWriter writer;
  fields(writer);
  return writer.texts;
}

void assign(const FieldList& fields, std::string_view name, std::string_view text) {
  TextReader reader(name, text);
  fields(reader);
  if (reader.is_found) return;
  throw InvalidInput(fmt::format("{} has no field {}; its fields are {}", reader.type, quoted(name),
                                 fmt::join(reader.names, ", ")));
}

void assign_words(const FieldList& fields, std::string_view words) {
  for (std::string_view word = next_word(words); !word.empty(); word = next_word(words)) {
    const std::size_t equals = word.find('=');
    if (equals == std::string_view::npos) {
      throw InvalidInput(
          fmt::format("{}: must be NAME=VALUE, such as tolerance=1e-4", quoted(word)));
    }
    assign(fields, word.substr(0, equals), word.substr(equals + 1));
  }
}

}  // namespace palpate
