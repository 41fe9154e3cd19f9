// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/specimen_file.h"

#include <array>
#include <utility>

#include "palpate/documents/document.h"
#include "palpate/documents/document_node.h"
#include "palpate/probing/closed_form.h"
#include "specimen/closed_form_fields.h"
#include "specimen/finite_element_file.h"

namespace palpate::probing {
namespace {

using documents::DocumentMembers;
using documents::DocumentNode;

constexpr std::array kTypes = {"sheet", "beam", "elastic_body", "finite_elements"};

void take(DocumentMembers& members, const char* name, double& field, const Interval& range,
          const char* unit) {
  members.take(name, field, range, unit);
}

// Every point of a file may have any finite coordinates.
void take(DocumentMembers& members, const char* name, Eigen::Vector2d& field,
          const Interval& /*range*/, const char* /*unit*/) {
  if (const auto found = members.find(name))
    found->read({field.data(), 2}, "two numbers such as [5, -20]");
}

template <typename Object>
std::unique_ptr<Specimen> specimen_of(const DocumentNode& node) {
  Object object;
  DocumentMembers members(node);
  (void)members.find("type");
  visit_fields(object, [&](const char* name, auto& field, const Interval& range, const char* unit) {
    take(members, name, field, range, unit);
  });
  members.end();
  return make_specimen(object);
}

std::size_t type_of(const DocumentNode& node) { return node.at("type").choice(kTypes); }

}  // namespace

std::unique_ptr<Specimen> parse_specimen(const std::string& text, const std::string& source) {
  const documents::Document document = documents::parse_json(text, source);
  return documents::in_file(source, [&]() -> std::unique_ptr<Specimen> {
    const DocumentNode node(document);
    switch (type_of(node)) {
      case 0:
        return specimen_of<Sheet>(node);
      case 1:
        return specimen_of<Beam>(node);
      case 2:
        return specimen_of<ElasticBody>(node);
      default:
        FiniteElementObject object = finite_elements_of(node);
        return make_specimen(std::move(object.body), object.options);
    }
  });
}

FiniteElementObject parse_finite_elements(const std::string& text, const std::string& source) {
  const documents::Document document = documents::parse_json(text, source);
  return documents::in_file(source, [&] {
    const DocumentNode node(document);
    node.at("type").expect_text("finite_elements");
    return finite_elements_of(node);
  });
}

}  // namespace palpate::probing
