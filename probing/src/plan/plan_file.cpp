// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/core/input_file.h"
#include "palpate/core/output_file.h"
#include "palpate/probing/contact_plan.h"

namespace palpate::probing {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kFormat = "palpate contact plan";
constexpr int kVersion = 1;
constexpr const char* kHighestForce = "highest_force";

// The members of the options, for reading and writing alike.
template <typename Options, typename Visit>
void visit_options(Options& options, Visit&& visit) {
  visit("spacing", options.spacing);
  visit("tip_radius", options.tip_radius);
  visit("border", options.border);
  visit("view_angle", options.view_angle);
  visit("lowest_force", options.lowest_force);
  visit("levels", options.levels);
  visit("directions", options.directions);
  visit("max_force", options.max_force);
}

Json numbers(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

Eigen::Vector3d vector_of(const Json& json) {
  if (json.size() != 3) throw InvalidInput("a vector does not have three numbers");
  return {json[0].get<double>(), json[1].get<double>(), json[2].get<double>()};
}

ContactPlan plan_of(const Json& json) {
  if (json.at("format") != kFormat) throw InvalidInput("'format' is not 'palpate contact plan'");
  if (json.at("version") != kVersion) {
    throw InvalidInput("is of version " + json.at("version").dump() + "; this program reads 1");
  }
  ContactPlan plan;
  const Json& options = json.at("options");
  plan.options.pattern = options.at("pattern") == to_string(PlanPattern::grid)
                             ? PlanPattern::grid
                             : PlanPattern::farthest_point;
  visit_options(plan.options,
                [&](const char* name, auto& value) { options.at(name).get_to(value); });
  if (options.contains(kHighestForce))
    plan.options.highest_force = options[kHighestForce].get<double>();
  plan.options.sensor = vector_of(options.at("sensor"));
  plan.surface = json.at("surface").get<std::string>();
  plan.cover = json.at("cover").is_null() ? std::numeric_limits<double>::infinity()
                                          : json.at("cover").get<double>();
  for (int i = 0; const auto& [name, count] : json.at("vertices").items()) {
    if (name != to_string(static_cast<Eligibility>(i++)))
      throw InvalidInput("'vertices' has an unknown member '" + name + "'");
    plan.excluded.push_back(count.get<Eigen::Index>());
  }
  json.at("normal_forces").get_to(plan.normal_forces);
  for (const Json& contact : json.at("contacts")) {
    plan.contacts.push_back({contact.at("id").get<long long>(), vector_of(contact.at("position")),
                             vector_of(contact.at("normal"))});
  }
  // Checks ids, places and normals.
  Acquisition contacts;
  contacts.contacts = plan.contacts;
  (void)CheckedAcquisition(std::move(contacts));
  for (const double force : plan.normal_forces) {
    if (!(force > 0 && force <= plan.options.max_force))
      throw InvalidInput("'normal_forces' has " + Json(force).dump() +
                         "; it must be in (0, max_force]");
  }
  return plan;
}

}  // namespace

std::string to_text(const ContactPlan& plan) {
  Json options{{"pattern", to_string(plan.options.pattern)}};
  visit_options(plan.options, [&](const char* name, const auto& value) { options[name] = value; });
  if (plan.options.highest_force) options[kHighestForce] = *plan.options.highest_force;
  options["sensor"] = numbers(plan.options.sensor);
  Json vertices = Json::object(), contacts = Json::array();
  for (std::size_t i = 0; i < plan.excluded.size(); ++i)
    vertices[to_string(static_cast<Eligibility>(i))] = plan.excluded[i];
  for (const Contact& contact : plan.contacts) {
    contacts.push_back({{"id", contact.id},
                        {"position", numbers(contact.position)},
                        {"normal", numbers(contact.normal)}});
  }
  const Json json{{"format", kFormat},
                  {"version", kVersion},
                  {"surface", plan.surface},
                  {"options", options},
                  {"vertices", vertices},
                  {"cover", std::isfinite(plan.cover) ? Json(plan.cover) : Json()},
                  {"normal_forces", plan.normal_forces},
                  {"contacts", contacts}};
  return json.dump(1) + "\n";
}

ContactPlan parse_plan(const std::string& text, const std::string& source) {
  const Json json = Json::parse(text, nullptr, false);
  if (!json.is_object()) {
    throw FileError(source + ": is not a JSON object; expected a plan of 'palpate probe plan'");
  }
  try {
    return plan_of(json);
  } catch (const InvalidInput& wrong) {
    throw FileError(source + ": " + wrong.what() + "; expected a plan of 'palpate probe plan'");
  } catch (const Json::exception& wrong) {
    throw FileError(source + ": " + wrong.what() + "; expected a plan of 'palpate probe plan'");
  }
}

ContactPlan read_plan(const std::filesystem::path& path) {
  return parse_plan(read_input_file(path), path.string());
}

void write_plan(const std::filesystem::path& path, const ContactPlan& plan) {
  write_file(path, [&](std::ostream& out) { out << to_text(plan); });
}

}  // namespace palpate::probing
