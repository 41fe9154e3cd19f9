// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "model/document_fields.h"

#include <utility>

namespace palpate::haptics {
namespace {

class DocumentReader : public FieldVisitor {
 public:
  explicit DocumentReader(const DocumentNode& node) : node_(node) {}

  std::vector<std::string> names;

  void begin(std::string_view /*type*/) override {}

 private:
  void on_real(const Field& field, const NumberField<double>& value) override {
    const auto member = find(field);
    if (!member) return;
    const double number = member->number();
    if (!value.range.contains(number)) member->refuse("a number " + to_string(value.range));
    value.set(number);
  }
  void on_whole(const Field& field, const NumberField<int>& value) override {
    const auto member = find(field);
    if (!member) return;
    const long long number = member->integer();
    if (!std::in_range<int>(number) || !value.range.contains(static_cast<double>(number)))
      member->refuse("a whole number " + to_string(value.range));
    value.set(static_cast<int>(number));
  }
  void on_flag(const Field& field, bool /*value*/, const std::function<void(bool)>& set) override {
    if (const auto member = find(field)) set(member->truth());
  }
  void on_choice(const Field& field, const ChoiceField& value) override {
    const auto member = find(field);
    if (!member) return;
    const std::vector<std::string> copies(value.words.begin(), value.words.end());
    std::vector<const char*> words;
    for (const std::string& copy : copies) words.push_back(copy.c_str());
    value.set(member->choice(words));
  }
  void on_table(const Field& field, const TableField& value) override {
    const auto member = find(field);
    if (!member) return;
    TableField::Rows rows;
    for (const DocumentNode& item : member->items()) {
      rows.emplace_back(value.columns.size());
      item.read(rows.back(), "a row of numbers");
    }
    value.set(rows);
  }

  std::optional<DocumentNode> find(const Field& field) {
    names.emplace_back(field.name);
    return node_.find(names.back().c_str());
  }

  const DocumentNode& node_;
};

}  // namespace

void read_fields(const DocumentNode& node, const FieldList& fields) {
  DocumentReader reader(node);
  fields(reader);
  node.expect_only(reader.names);
}

}  // namespace palpate::haptics
