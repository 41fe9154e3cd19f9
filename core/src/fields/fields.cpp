// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/core/fields.h"

namespace palpate {
namespace {

class RangeCheck : public FieldVisitor {
 public:
  void begin(std::string_view type) override { type_ = std::string(type) + "::"; }

 private:
  void on_real(const Field& field, const NumberField<double>& value) override {
    require(type_ + std::string(field.name), value.value, value.range, field.unit);
  }
  void on_whole(const Field& field, const NumberField<int>& value) override {
    if (value.value)
      require(type_ + std::string(field.name), *value.value, value.range, field.unit);
  }
  void on_flag(const Field& /*field*/, bool /*value*/,
               const std::function<void(bool)>& /*set*/) override {}
  void on_choice(const Field& /*field*/, const ChoiceField& /*value*/) override {}
  void on_table(const Field& field, const TableField& value) override {
    for (std::size_t row = 0; row < value.value.size(); ++row) {
      for (std::size_t column = 0; column < value.columns.size(); ++column) {
        const auto name = [&] {
          return type_ + std::string(field.name) + "[" + std::to_string(row) + "]." +
                 std::string(value.columns[column].name);
        };
        require(name, value.value[row][column], value.columns[column].range);
      }
    }
  }

  std::string type_;
};

}  // namespace

void require_in_range(const FieldList& fields) {
  RangeCheck check;
  fields(check);
}

}  // namespace palpate
