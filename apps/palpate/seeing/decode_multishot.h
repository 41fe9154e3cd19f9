// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>

#include "palpate/sensing/frame_source.h"
#include "palpate/sensing/multishot.h"
#include "palpate/sensing/response.h"
#include "seeing/decode_outputs.h"
#include "shared/command_line.h"

namespace palpate::apps {

/// A call of `decode --multishot`.
struct MultishotCall {
  const sensing::MultishotDecoder& decoder;
  sensing::FrameSource& source;            ///< all images, scene after scene
  const sensing::Linearizer* linearizer;   ///< null: the images are linear in the light
  std::filesystem::path output;            ///< the folder for the results
  DecodeOutputs outputs;                   ///< without its folder
  nlohmann::ordered_json record_settings;  ///< everything that range maps depend on
  bool writes_rig = true;  ///< false: the rig of the call is already in the output folder
};

/// Decodes each scene's images into one range map, and reports them. A scene of which an image
/// cannot be read is reported and skipped.
/// \throws InvalidInput if the number of images is not a multiple of those of a scene.
/// \throws Error if a scene could not be decoded, after the others.
void decode_multishot(const Settings& settings, MultishotCall call);

}  // namespace palpate::apps
