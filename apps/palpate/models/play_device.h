// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "models/device_call.h"
#include "shared/command_line.h"

namespace palpate::apps {

/// Runs the loop between a device and a model.
void play_device(const Settings& settings, const DeviceCall& call);

/// Runs the loop between a device and a tool of a scene.
void play_scene_device(const Settings& settings, DeviceCall call);

/// Reports which stiffness is calm for a model and a device, and which rate and damping it needs.
void play_stability(const Settings& settings, const DeviceCall& call);

/// Replays a session. \throws Error if it differs.
void play_replay(const Settings& settings, const fs::path& model, const fs::path& exchange,
                 const fs::path& session);
/// The same for a scene.
void play_scene_replay(const Settings& settings, const fs::path& scene, const fs::path& session);

}  // namespace palpate::apps
