// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/devices/device_description_json.h"

#include <nlohmann/json.hpp>

#include "palpate/core/error.h"

namespace palpate::devices {
namespace {

using DescriptionJson = nlohmann::ordered_json;

// Calls visit(name, member, needed) for each member that a record keeps. Those that are needed are
// in every version of a record.
template <typename Description, typename Visit>
void for_each_member(Description& d, Visit&& visit) {
  visit("name", d.name, true);
  visit("period", d.period, true);
  visit("highest_force", d.highest_force, true);
  visit("continuous_force", d.continuous_force, false);
  visit("measures_joints", d.measures_joints, false);
  visit("measures_force", d.measures_force, false);
  visit("measures_heat", d.measures_heat, false);
  visit("measures_reference", d.measures_reference, false);
  visit("real_time", d.real_time, false);
  visit("highest_torque", d.highest_torque, false);
  visit("damping", d.damping, false);
  visit("friction", d.friction, false);
  visit("resolution", d.resolution, false);
  visit("delay", d.delay, false);
  visit("workspace_scale", d.workspace_scale, false);
  visit("clutch_buttons", d.clutch_buttons, false);
}

}  // namespace

std::string to_json(const DeviceDescription& description) {
  DescriptionJson json;
  for_each_member(description,
                  [&](const char* name, const auto& member, bool) { json[name] = member; });
  return json.dump(-1, ' ', false, DescriptionJson::error_handler_t::replace);
}

DeviceDescription device_description_of(std::string_view text) {
  try {
    const DescriptionJson json = DescriptionJson::parse(text);
    DeviceDescription description;
    for_each_member(description, [&](const char* name, auto& member, bool needed) {
      if (needed || json.contains(name)) json.at(name).get_to(member);
    });
    return description;
  } catch (const nlohmann::json::exception& wrong) {
    throw InvalidInput(std::string("the description of a device is damaged: ") + wrong.what());
  }
}

}  // namespace palpate::devices
