// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/devices/device.h"
#include "palpate/devices/device_plugin.h"

namespace palpate::devices {

/// The structs of `device_plugin.h` and the values of `device.h`: the same content.
[[nodiscard]] DeviceDescription description_of(const palpate_device_info_v1& info, bool real_time);
[[nodiscard]] palpate_device_info_v1 struct_of(const DeviceDescription& description) noexcept;

/// A state in which nothing is measured yet, for a driver to fill.
[[nodiscard]] palpate_device_state_v1 unmeasured_state() noexcept;
[[nodiscard]] DeviceState state_of(const palpate_device_state_v1& measured,
                                   const DeviceDescription& description) noexcept;
[[nodiscard]] palpate_device_state_v1 struct_of(const DeviceState& state) noexcept;

[[nodiscard]] palpate_device_command_v1 struct_of(const DeviceCommand& command) noexcept;
[[nodiscard]] DeviceCommand command_of(const palpate_device_command_v1& command) noexcept;

}  // namespace palpate::devices
