// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/field_options.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <numbers>
#include <optional>
#include <sstream>
#include <type_traits>

#include "palpate/core/field_text.h"
#include "palpate/core/input_file.h"
#include "palpate/geometry/option_lists.h"
#include "palpate/haptics/option_lists.h"
#include "palpate/probing/option_lists.h"
#include "palpate/sensing/option_lists.h"
#include "shared/call_checks.h"

namespace palpate::apps {
namespace {

std::string name_of(const auto& field) {
  return option_name(field.option.empty() ? field.name : field.option);
}

/// The flag that changes a field: "--rate", or "--no-rate" for one that is true by default.
std::string flag_name(std::string_view field, bool usual) {
  return (usual ? "--no-" : "--") + option_name(field).substr(2);
}

/// The form in which a command shows numbers of a unit: angles in degrees.
struct ShownUnit {
  std::string name;
  bool is_angle = false;

  explicit ShownUnit(std::string_view unit)
      : name(unit == "rad" ? "degrees" : unit), is_angle(unit == "rad") {}

  // In this order, pi is 180, and 180 is pi.
  template <typename Number>
  [[nodiscard]] Number shown(Number value) const {
    return is_angle ? static_cast<Number>(value / std::numbers::pi * 180) : value;
  }
  template <typename Number>
  [[nodiscard]] Number meant(Number value) const {
    return is_angle ? static_cast<Number>(value / 180 * std::numbers::pi) : value;
  }
  [[nodiscard]] Interval shown_range(Interval range) const {
    range.low = shown(range.low);
    range.high = shown(range.high);
    return range;
  }
};

/// The options of all fields of the libraries: "RemeshingOptions::edge_length" is "--remesh".
const std::map<std::string, std::string>& listed_options() {
  static const std::map<std::string, std::string> names = [] {
    std::map<std::string, std::string> found;
    const auto all = [](FieldVisitor& visitor) {
      geometry::visit_options(visitor);
      sensing::visit_options(visitor);
      probing::visit_options(visitor);
      haptics::visit_options(visitor);
    };
    for (const FieldText& field : texts_of(all)) {
      found[field.type + "::" + field.name] =
          field.is_flag ? flag_name(field.name, field.text == "true") : name_of(field);
    }
    return found;
  }();
  return names;
}

/// The value of a field as its option takes it.
std::string shown(const FieldText& field) {
  const ShownUnit unit(field.unit);
  const std::optional<double> angle = parse_number<double>(field.text);
  return unit.is_angle && angle ? fmt::format("{}", unit.shown(*angle)) : field.text;
}

class OptionMaker : public FieldVisitor {
 public:
  OptionMaker(CLI::App& command, std::span<const std::string_view> only)
      : command_(command), only_(only) {}

  std::vector<CLI::Option*> made;

  void begin(std::string_view /*type*/) override {}

 private:
  void on_real(const Field& field, const NumberField<double>& value) override {
    add_number(field, value);
  }
  void on_whole(const Field& field, const NumberField<int>& value) override {
    add_number(field, value);
  }
  void on_flag(const Field& field, bool value, const std::function<void(bool)>& set) override {
    if (!is_wanted(field)) return;
    const std::string name = flag_name(field.name, value);
    std::string text = text_of(field);
    if (value)
      text = "Do not " + std::string(1, static_cast<char>(std::tolower(text[0]))) + text.substr(1);
    keep(field, command_.add_flag_callback(
                    name, [set, value] { set(!value); }, text));
  }
  void on_choice(const Field& field, const ChoiceField& value) override {
    if (!is_wanted(field)) return;
    const std::vector<std::string> words(value.words.begin(), value.words.end());
    CLI::Option* option = command_.add_option_function<std::string>(
        name_of(field),
        [words, set = value.set](const std::string& word) {
          set(static_cast<std::size_t>(std::ranges::find(words, word) - words.begin()));
        },
        text_of(field));
    option->check(one_of(words))->default_str(words[value.value]);
    keep(field, option);
  }
  void on_table(const Field& field, const TableField& value) override {
    if (!is_wanted(field)) return;
    std::string names;
    for (const auto& column : value.columns)
      names += (names.empty() ? "" : ",") + std::string(column.name);
    const std::string name = name_of(field);
    const auto take = [set = value.set, width = value.columns.size(), name,
                       names](const std::vector<double>& numbers) {
      if (numbers.size() % width != 0) {
        throw InvalidInput(fmt::format("{}: {} are {} numbers each time; there are {} in all", name,
                                       names, width, numbers.size()));
      }
      TableField::Rows rows;
      for (std::size_t i = 0; i < numbers.size(); i += width)
        rows.emplace_back(&numbers[i], &numbers[i] + width);
      set(rows);
    };
    CLI::Option* option = command_.add_option_function<std::vector<double>>(
        name, take, names + " (repeat for more): " + text_of(field));
    option->expected(static_cast<int>(value.columns.size()))->take_all()->delimiter(',');
    keep(field, option);
  }

  template <typename Number>
  void add_number(const Field& field, const NumberField<Number>& value) {
    if (!is_wanted(field)) return;
    const ShownUnit unit(field.unit);
    CLI::Option* option = command_.add_option_function<Number>(
        name_of(field), [set = value.set, unit](const Number& given) { set(unit.meant(given)); },
        text_of(field));
    option->check(checked<Number>(unit.shown_range(value.range)));
    if (value.value) option->default_str(fmt::format("{}", unit.shown(*value.value)));
    keep(field, option);
  }

  template <typename Number>
  static CLI::Validator checked(const Interval& range) {
    if constexpr (std::is_integral_v<Number>) {
      const std::string right = "a whole number " + to_string(range);
      return {[range, right](const std::string& text) {
                const std::optional<Number> number = parse_number<Number>(text);
                return number && range.contains(*number) ? std::string()
                                                         : "is " + text + "; it must be " + right;
              },
              to_string(range)};
    }
    return within(range);
  }

  static std::string text_of(const Field& field) {
    return std::string(field.description) +
           (field.unit.empty() ? "" : " [" + ShownUnit(field.unit).name + "]");
  }

  [[nodiscard]] bool is_wanted(const Field& field) const {
    return only_.empty() || std::ranges::find(only_, field.name) != only_.end();
  }

  void keep(const Field& field, CLI::Option* option) {
    if (field.expert) option->group(kExpertOptions);
    made.push_back(option);
  }

  CLI::App& command_;
  std::span<const std::string_view> only_;
};

/// The innermost subcommand that was called.
const CLI::App& called(const CLI::App& app) {
  const std::vector<CLI::App*> inner = app.get_subcommands();
  return inner.empty() ? app : called(*inner.front());
}

}  // namespace

std::vector<CLI::Option*> add_fields(CLI::App& command, const FieldList& fields,
                                     std::span<const std::string_view> only) {
  OptionMaker maker(command, only);
  fields(maker);
  return maker.made;
}

void add_fields_of(CLI::Option& flag, CLI::App& command, const FieldList& fields) {
  for (CLI::Option* option : add_fields(command, fields)) {
    option->needs(&flag);
    if (option->get_group() != kExpertOptions) option->group("With " + flag.get_name());
  }
}

CLI::Validator value_of_field(const FieldList& fields, const std::string& name) {
  const std::vector<FieldText> texts = texts_of(fields);
  return {[fields, name](const std::string& text) -> std::string {
            try {
              assign(fields, name, text);
              return {};
            } catch (const InvalidInput& error) {
              return error.with_names([](const std::string&) { return ""; }).substr(1);
            }
          },
          std::ranges::find(texts, name, &FieldText::name)->range};
}

Json option_values(const FieldList& fields) {
  Json values;
  for (const FieldText& field : texts_of(fields)) values[name_of(field)] = shown(field);
  return values;
}

std::string changed_options(const FieldList& fields, const FieldList& usual) {
  const std::vector<FieldText> now = texts_of(fields), before = texts_of(usual);
  std::string words;
  for (std::size_t i = 0; i < now.size(); ++i) {
    if (now[i].text == before[i].text) continue;
    if (now[i].is_flag) {
      words += " " + flag_name(now[i].name, before[i].text == "true");
      continue;
    }
    const std::string option = " " + name_of(now[i]);
    // Each row of a table is given separately.
    std::istringstream rows(shown(now[i]));
    for (std::string row; std::getline(rows, row, ';');) words += option + " " + row;
  }
  return words;
}

std::string option_name(std::string_view field) {
  std::string name = "--" + std::string(field);
  std::ranges::replace(name, '_', '-');
  return name;
}

std::string field_option(const std::string& name) {
  const std::size_t type = name.rfind("::");
  if (type == std::string::npos) return name;  // an argument, or a place in a file
  const std::string field = name.substr(0, name.find_first_of("[.", type));
  const auto listed = listed_options().find(field);
  return listed == listed_options().end() ? option_name(field.substr(type + 2)) : listed->second;
}

std::string with_names(const InvalidInput& error, const std::map<std::string, std::string>& names) {
  return error.with_names([&](const std::string& name) {
    const auto found = names.find(name);
    return found == names.end() ? field_option(name) : found->second;
  });
}

std::string with_option_names(const InvalidInput& error, const CLI::App& app) {
  const CLI::App& command = called(app);
  return error.with_names([&](const std::string& name) {
    const std::size_t type = name.rfind("::");
    if (type == std::string::npos) return name;  // an argument, or a place in a file
    const std::string option = field_option(name);
    return command.get_option_no_throw(option) != nullptr ? option : name.substr(type + 2);
  });
}

}  // namespace palpate::apps
