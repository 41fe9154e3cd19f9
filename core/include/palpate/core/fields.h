// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "palpate/core/require.h"

namespace palpate {

/// Description of one field in a list of fields, without its value and its range.
struct Field {
  std::string_view name;  ///< as in C++ and Python, "min_signal"; on the command line --min-signal
  /// One sentence for users, without the unit, the range and the default, which follow it.
  std::string_view description;
  /// "mm", "px"; "rad": an angle, which the command line takes in degrees; empty: a plain number
  std::string_view unit = {};
  bool expert = false;  ///< few users set it: --help-all shows it, and --help does not
  /// Its name on the command line if that is another: "anchor" for a table "anchors", of which each
  /// option gives one row; "remesh" for `edge_length`, since that alone does not say of what.
  std::string_view option = {};
};

/// The value of a field that is a number.
template <typename Number>
struct NumberField {
  std::optional<Number> value;  ///< none: the field may be left out, and is left out
  Interval range;
  bool may_be_absent = false;
  std::function<void(std::optional<Number>)> set;
};

/// The value of a field that is one of several words, as an index into them.
struct ChoiceField {
  std::size_t value = 0;
  std::span<const std::string_view> words;
  std::function<void(std::size_t)> set;
};

/// The value of a field that is a table: rows of numbers, such as points.
struct TableField {
  struct Column {
    std::string_view name;
    Interval range;
  };
  using Rows = std::vector<std::vector<double>>;

  Rows value;
  std::span<const Column> columns;
  std::function<void(const Rows&)> set;
};

/// Base class of operations on each field of a struct: to check it, to read or write it, or to make
/// an option or a keyword argument of it.
///
/// A struct that users fill in has one list of its fields: a function beside it that calls a
/// visitor for each in turn, and states its name, unit, range and meaning in one place:
///
///     void visit(DecodeOptions& options, FieldVisitor& visitor) {
///       visitor.begin("DecodeOptions");
///       visitor.real({"min_signal", "A pixel is lit if ...", "of full scale"}, options.min_signal,
///                    above(0).below(1));
///       ...
///     }
///
/// A visitor may keep the functions that set fields: the struct must outlive it.
class FieldVisitor {
 public:
  FieldVisitor() = default;
  virtual ~FieldVisitor() = default;
  FieldVisitor(const FieldVisitor&) = delete;
  FieldVisitor& operator=(const FieldVisitor&) = delete;

  /// Called first.
  /// \param type name of the struct, "DecodeOptions".
  virtual void begin(std::string_view type) = 0;

  void real(const Field& field, double& value, const Interval& range) {
    on_real(field, {value, range, false, [&value](auto given) { value = *given; }});
  }
  void real(const Field& field, std::optional<double>& value, const Interval& range) {
    on_real(field, {value, range, true, [&value](auto given) { value = given; }});
  }
  void whole(const Field& field, int& value, const Interval& range) {
    on_whole(field, {value, range, false, [&value](auto given) { value = *given; }});
  }
  void whole(const Field& field, unsigned& value, const Interval& range) {
    on_whole(field, {static_cast<int>(value), range, false,
                     [&value](auto given) { value = static_cast<unsigned>(*given); }});
  }
  void whole(const Field& field, std::optional<int>& value, const Interval& range) {
    on_whole(field, {value, range, true, [&value](auto given) { value = given; }});
  }
  void flag(const Field& field, bool& value) {
    on_flag(field, value, [&value](bool given) { value = given; });
  }
  /// An enumeration whose values 0, 1, ... have these words.
  template <typename Enum>
  void choice(const Field& field, Enum& value, std::span<const std::string_view> words) {
    on_choice(field, {static_cast<std::size_t>(value), words,
                      [&value](auto chosen) { value = static_cast<Enum>(chosen); }});
  }
  /// The same with one more word at the end, which stands for no value.
  template <typename Enum>
  void choice(const Field& field, std::optional<Enum>& value,
              std::span<const std::string_view> words) {
    const std::size_t none = words.size() - 1;
    on_choice(field,
              {value ? static_cast<std::size_t>(*value) : none, words, [&value, none](auto chosen) {
                 value = chosen == none ? std::nullopt : std::optional(static_cast<Enum>(chosen));
               }});
  }
  void table(const Field& field, const TableField& value) { on_table(field, value); }

 private:
  virtual void on_real(const Field& field, const NumberField<double>& value) = 0;
  virtual void on_whole(const Field& field, const NumberField<int>& value) = 0;
  virtual void on_flag(const Field& field, bool value, const std::function<void(bool)>& set) = 0;
  virtual void on_choice(const Field& field, const ChoiceField& value) = 0;
  virtual void on_table(const Field& field, const TableField& value) = 0;
};

/// The list of fields of a struct, for functions that take the list of any struct.
using FieldList = std::function<void(FieldVisitor&)>;

template <typename Struct>
[[nodiscard]] FieldList fields_of(Struct& fields) {
  return [&fields](FieldVisitor& visitor) { visit(fields, visitor); };
}

/// \throws InvalidInput that names the first field outside its range: "DecodeOptions::min_signal is
/// -1; it must be in (0, 1)".
void require_in_range(const FieldList& fields);

/// Checks options and returns them unchanged.
/// \throws InvalidInput as `require_in_range`.
template <typename Options>
[[nodiscard]] Options in_range(Options options) {
  require_in_range(fields_of(options));
  return options;
}

}  // namespace palpate
