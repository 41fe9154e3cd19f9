// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/probing/arm.h"
#include "palpate/probing/device_plugin.h"

namespace palpate::probing {

/// The structs of `device_plugin.h` and the values of `arm.h`: the same content.
[[nodiscard]] ArmDescription description_of(const palpate_device_info_v1& info, bool real_time);
[[nodiscard]] palpate_device_info_v1 struct_of(const ArmDescription& description) noexcept;

/// A state in which nothing is measured yet, for a driver to fill.
[[nodiscard]] palpate_device_state_v1 unmeasured_state() noexcept;
[[nodiscard]] ArmState state_of(const palpate_device_state_v1& measured,
                                const ArmDescription& description) noexcept;
[[nodiscard]] palpate_device_state_v1 struct_of(const ArmState& state) noexcept;

[[nodiscard]] palpate_device_command_v1 struct_of(const ArmCommand& command) noexcept;
[[nodiscard]] ArmCommand command_of(const palpate_device_command_v1& command) noexcept;

}  // namespace palpate::probing
