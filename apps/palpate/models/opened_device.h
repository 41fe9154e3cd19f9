// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>

#include "models/device_call.h"
#include "palpate/haptics/device_loop.h"
#include "palpate/probing/arm.h"

namespace palpate::apps {

struct OpenedDevice {
  std::unique_ptr<probing::Arm> arm;
  double duration = 0;  ///< [s] of its path; 0: without end
};

/// Opens the simulated device or the driver that a call names.
/// \throws InvalidInput on settings that it does not have, or without a trajectory that it needs.
[[nodiscard]] OpenedDevice open_device(const DeviceCall& call,
                                       const haptics::DeviceLoopOptions& options);

/// The same for drivers only.
[[nodiscard]] OpenedDevice open_driver(const DeviceCall& call);

}  // namespace palpate::apps
