// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "palpate/devices/device.h"

namespace palpate::devices {

/// A description as one JSON object, for the heads of records. Letters of the name that are not
/// Unicode are replaced.
[[nodiscard]] std::string to_json(const DeviceDescription& description);

/// The description in a JSON object, which may have other members. Those that an older record does
/// not have are as in `DeviceDescription`.
/// \throws InvalidInput saying which member is missing or of a wrong type.
[[nodiscard]] DeviceDescription device_description_of(std::string_view json);

}  // namespace palpate::devices
