// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "fields.h"

#include <algorithm>
#include <cstddef>
#include <string_view>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/geometry/option_lists.h"
#include "palpate/haptics/option_lists.h"
#include "palpate/probing/option_lists.h"
#include "palpate/sensing/option_lists.h"

namespace palpate::python {
namespace {

/// "u_px, v_px, z"
std::string names_of(const TableField& table) {
  std::string names;
  for (const auto& column : table.columns)
    names += (names.empty() ? "" : ", ") + std::string(column.name);
  return names;
}

/// "'flood', 'snakes'"
std::string words_of(const ChoiceField& choice) {
  std::string words;
  for (const std::string_view word : choice.words)
    words += (words.empty() ? "'" : ", '") + std::string(word) + "'";
  return words;
}

class KeywordReader : public FieldVisitor {
 public:
  explicit KeywordReader(const py::kwargs& given) : given_(given) {}

  std::vector<std::string> names;

  void begin(std::string_view /*type*/) override {}

 private:
  void on_real(const Field& field, const NumberField<double>& value) override {
    read_number(field, value);
  }
  void on_whole(const Field& field, const NumberField<int>& value) override {
    read_number(field, value);
  }
  void on_flag(const Field& field, bool /*value*/, const std::function<void(bool)>& set) override {
    if (const auto given = read<bool>(field)) set(*given);
  }
  void on_choice(const Field& field, const ChoiceField& value) override {
    const auto word = read<std::string>(field);
    if (!word) return;
    const auto found = std::ranges::find(value.words, *word);
    if (found == value.words.end()) {
      throw InvalidInput(std::string(field.name) + " is '" + *word + "'; it must be one of " +
                         words_of(value));
    }
    value.set(static_cast<std::size_t>(found - value.words.begin()));
  }
  void on_table(const Field& field, const TableField& value) override {
    const auto rows = read<TableField::Rows>(field);
    if (!rows) return;
    for (const std::vector<double>& row : *rows) {
      if (row.size() == value.columns.size()) continue;
      throw InvalidInput(std::string(field.name) + ": each row must have " +
                         std::to_string(value.columns.size()) + " numbers: " + names_of(value));
    }
    value.set(*rows);
  }

  template <typename Number>
  void read_number(const Field& field, const NumberField<Number>& value) {
    if (value.may_be_absent) {
      if (const auto given = read<std::optional<Number>>(field)) value.set(*given);
    } else if (const auto given = read<Number>(field)) {
      value.set(*given);
    }
  }

  /// None if the field is not given.
  template <typename Value>
  std::optional<Value> read(const Field& field) {
    const std::string name(field.name);
    names.push_back(name);
    if (!given_.contains(name.c_str())) return std::nullopt;
    const py::object object = given_[name.c_str()];
    try {
      return object.cast<Value>();
    } catch (const py::cast_error&) {
      throw py::type_error(name + ": is of type " +
                           std::string(py::str(py::type::of(object).attr("__name__"))) +
                           ", which cannot be converted");
    }
  }

  const py::kwargs& given_;
};

/// A field in words.
struct DescribedField {
  Field field;
  std::string type;   ///< of Python: "float"
  std::string usual;  ///< its default, as Python shows it
  std::string range;  ///< "in (0, 1)", "'flood' or 'snakes'"; empty for flags
};

struct DescribedList {
  std::string type;
  std::vector<DescribedField> fields;
};

class Describer : public FieldVisitor {
 public:
  std::vector<DescribedList> lists;

  void begin(std::string_view type) override { lists.push_back({std::string(type), {}}); }

 private:
  void on_real(const Field& field, const NumberField<double>& value) override {
    add_number(field, "float", value);
  }
  void on_whole(const Field& field, const NumberField<int>& value) override {
    add_number(field, "int", value);
  }
  void on_flag(const Field& field, bool value, const std::function<void(bool)>& /*set*/) override {
    add(field, "bool", value ? "True" : "False", "");
  }
  void on_choice(const Field& field, const ChoiceField& value) override {
    add(field, "Literal[" + words_of(value) + "]",
        "'" + std::string(value.words[value.value]) + "'", "");
  }
  void on_table(const Field& field, const TableField& value) override {
    add(field, "Sequence[Sequence[float]]", "[]", "rows of " + names_of(value));
  }

  template <typename Number>
  void add_number(const Field& field, const char* type, const NumberField<Number>& value) {
    const std::string usual = value.value ? py::repr(py::cast(*value.value)) : py::str("None");
    add(field, or_none(type, value), usual, to_string(value.range));
  }
  static std::string or_none(const std::string& type, const auto& value) {
    return value.may_be_absent ? type + " | None" : type;
  }
  void add(const Field& field, const std::string& type, const std::string& usual,
           const std::string& range) {
    lists.back().fields.push_back({field, type, usual, range});
  }
};

}  // namespace

py::list option_lists() {
  Describer describer;
  geometry::visit_options(describer);
  sensing::visit_options(describer);
  probing::visit_options(describer);
  haptics::visit_options(describer);
  py::list lists;
  for (const auto& [type, described] : describer.lists) {
    py::list fields;
    for (const auto& [field, type_of_value, usual, range] : described) {
      fields.append(py::dict(arg("name") = field.name, arg("option") = field.option,
                             arg("unit") = field.unit, arg("description") = field.description,
                             arg("expert") = field.expert, arg("type") = type_of_value,
                             arg("default") = usual, arg("range") = range));
    }
    lists.append(py::make_tuple(type, fields));
  }
  return lists;
}

void set_fields(const FieldList& fields, const py::kwargs& given) {
  KeywordReader reader(given);
  fields(reader);
  for (const auto& [key, value] : given) {
    const auto name = key.cast<std::string>();
    if (std::ranges::find(reader.names, name) == reader.names.end())
      throw py::type_error("'" + name + "' is not a keyword argument of this function");
  }
}

std::string described(const std::string& call, const std::string& result, const std::string& text,
                      const FieldList& list) {
  Describer describer;
  list(describer);
  std::string signature = call, lines;
  for (const DescribedList& each : describer.lists) {
    for (const auto& [field, type, usual, range] : each.fields) {
      const std::string name(field.name);
      signature += ", " + name + ": " + type + " = " + usual;
      lines += name + ": " + std::string(field.description);
      if (!field.unit.empty()) lines += " [" + std::string(field.unit) + "]";
      lines += range.empty() ? ".\n" : "; " + range + ".\n";
    }
  }
  return signature + ") -> " + result + "\n\n" + text + "\n\n" + lines;
}

}  // namespace palpate::python
