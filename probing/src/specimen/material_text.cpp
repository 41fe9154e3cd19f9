// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/material_text.h"

#include <array>
#include <nlohmann/json.hpp>

#include "palpate/core/error.h"
#include "palpate/probing/specimen_file.h"

namespace palpate::probing {
namespace {

using nlohmann::ordered_json;

void state(const Hyperelastic& material, ordered_json& members) {
  members["shear_modulus"] = material.shear_modulus;
  members["bulk_modulus"] = material.bulk_modulus;
}

ordered_json components(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Vector3d vector_of(const ordered_json& members, const char* name) {
  const auto v = members.at(name).get<std::array<double, 3>>();
  return {v[0], v[1], v[2]};
}

}  // namespace

std::string with_material(const std::string& text, const std::string& source,
                          const FiniteElementObject& object,
                          const std::vector<KnownPress>& presses) {
  const FiniteElementObject given = parse_finite_elements(text, source);
  const std::vector<Hyperelastic>& materials = object.body.materials;
  if (materials.size() != given.body.materials.size()) {
    throw InvalidInput("with_material(): the object has " + std::to_string(materials.size()) +
                       " regions, the text " + std::to_string(given.body.materials.size()));
  }
  ordered_json members = ordered_json::parse(text);
  state(materials[0], members);
  for (std::size_t r = 1; r < materials.size(); ++r) state(materials[r], members["regions"][r - 1]);
  members["friction"] = object.options.friction;
  const double before = given.body.support_moves.norm();
  if (before > 0) {
    const double factor =
        object.body.support_moves.cwiseProduct(given.body.support_moves).sum() / (before * before);
    for (ordered_json& support : members["supports"]) {
      if (!support.contains("move")) continue;
      for (ordered_json& component : support["move"]) component = factor * component.get<double>();
    }
  }
  ordered_json& listed = members["identified"]["presses"] = ordered_json::array();
  for (const KnownPress& press : presses)
    listed.push_back({{"contact", press.contact},
                      {"position", components(press.position)},
                      {"inward", components(press.inward)},
                      {"displacement", components(press.displacement)},
                      {"force", components(press.force)}});
  return members.dump(2) + "\n";
}

std::vector<KnownPress> parse_presses(const std::string& text, const std::string& source) {
  const ordered_json members = ordered_json::parse(text, nullptr, false);
  std::vector<KnownPress> result;
  if (!members.is_object() || !members.contains("identified")) return result;
  try {
    for (const ordered_json& press : members["identified"].at("presses"))
      result.push_back({press.at("contact").get<long long>(), vector_of(press, "position"),
                        vector_of(press, "inward"), vector_of(press, "displacement"),
                        vector_of(press, "force")});
  } catch (const ordered_json::exception&) {
    throw FileError(source + ": 'presses' in 'identified' are damaged; run palpate identify again");
  }
  return result;
}

}  // namespace palpate::probing
