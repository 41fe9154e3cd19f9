// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/specimen_file.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/probing/closed_form.h"
#include "specimen/closed_form_fields.h"
#include "specimen/finite_element_file.h"

namespace palpate::probing {
namespace {

using nlohmann::json;

constexpr const char* kTypes = "sheet, beam, elastic_body or finite_elements";

void take_member(const json& value, double& field) { field = value.get<double>(); }
void take_member(const json& value, Eigen::Vector2d& field) {
  field = {value.at(0).get<double>(), value.at(1).get<double>()};
}
bool fits(const json& value, const double&) { return value.is_number(); }
bool fits(const json& value, const Eigen::Vector2d&) {
  return value.is_array() && value.size() == 2 && value[0].is_number() && value[1].is_number();
}
const char* kind_of(const double&) { return "a number"; }
const char* kind_of(const Eigen::Vector2d&) { return "two numbers such as [5, -20]"; }

[[noreturn]] void refuse_member(const std::string& source, const std::string& name,
                                const std::string& type, const std::vector<std::string>& known) {
  std::string list;
  for (const std::string& each : known) list.append(list.empty() ? "" : ", ").append(each);
  throw FileError(source + ": '" + name + "' is unknown; a " + type + " has " + list);
}

template <typename Object>
std::unique_ptr<Specimen> specimen_of(const json& members, const std::string& source) {
  Object object;
  std::vector<std::string> known{"type"};
  visit_fields(
      object, [&](const char* name, auto& field, const Interval& /*range*/, const char* unit) {
        known.emplace_back(name);
        const auto member = members.find(name);
        if (member == members.end()) return;
        if (!fits(*member, field)) {
          throw FileError(source + ": '" + name + "' is " + member->dump() + "; it must be " +
                          kind_of(field) + (*unit ? std::string(" [") + unit + "]" : ""));
        }
        take_member(*member, field);
      });
  for (const auto& [name, value] : members.items()) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      refuse_member(source, name, members.at("type").get<std::string>(), known);
    }
  }
  try {
    return make_specimen(object);
  } catch (const InvalidInput& wrong) {
    throw FileError(source + ": " + wrong.what());
  }
}

json members_of(const std::string& text, const std::string& source) {
  json members = json::parse(text, nullptr, false);
  if (!members.is_object()) {
    throw FileError(source + R"(: is not a JSON object; it must be one such as {"type": "sheet"})");
  }
  const auto type = members.find("type");
  if (type == members.end() || !type->is_string())
    throw FileError(source + ": has no 'type'; it must be " + kTypes);
  return members;
}

}  // namespace

std::unique_ptr<Specimen> parse_specimen(const std::string& text, const std::string& source) {
  const json members = members_of(text, source);
  const json& type = members["type"];
  if (type == "sheet") return specimen_of<Sheet>(members, source);
  if (type == "beam") return specimen_of<Beam>(members, source);
  if (type == "elastic_body") return specimen_of<ElasticBody>(members, source);
  if (type == "finite_elements") {
    FiniteElementObject object = finite_elements_of(members, source);
    try {
      return make_specimen(std::move(object.body), object.options);
    } catch (const InvalidInput& wrong) {
      throw FileError(source + ": " + wrong.what());
    }
  }
  throw FileError(source + ": 'type' is " + type.dump() + "; it must be " + kTypes);
}

FiniteElementObject parse_finite_elements(const std::string& text, const std::string& source) {
  const json members = members_of(text, source);
  if (members["type"] != "finite_elements")
    throw FileError(source + ": 'type' is " + members["type"].dump() +
                    "; a solid must be of the type finite_elements");
  return finite_elements_of(members, source);
}

std::string read_specimen_text(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(file), {}};
  if (!file.good() && !file.eof()) {
    throw FileError(path.string() + ": cannot be read; pass a specimen file (JSON)");
  }
  return text;
}

}  // namespace palpate::probing
