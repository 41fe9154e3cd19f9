// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/documents/document_fields.h"

#include <utility>

namespace palpate::documents {
namespace {

class DocumentReader : public FieldVisitor {
 public:
  explicit DocumentReader(DocumentMembers& members) : members_(members) {}

  void begin(std::string_view /*type*/) override {}

 private:
  void on_real(const Field& field, const NumberField<double>& value) override {
    const auto member = find(field);
    if (!member) return;
    value.set(member->number(value.range, field.unit));
  }
  void on_whole(const Field& field, const NumberField<int>& value) override {
    const auto member = find(field);
    if (!member) return;
    value.set(member->integer(value.range));
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
    return members_.find(std::string(field.name).c_str());
  }

  DocumentMembers& members_;
};

}  // namespace

void take_fields(DocumentMembers& members, const FieldList& fields) {
  DocumentReader reader(members);
  fields(reader);
}

void read_fields(const DocumentNode& node, const FieldList& fields) {
  DocumentMembers members(node);
  take_fields(members, fields);
  members.end();
}

}  // namespace palpate::documents
