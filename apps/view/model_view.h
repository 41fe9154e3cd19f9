// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "felt_loop.h"
#include "palpate/haptics/model.h"
#include "view.h"

namespace palpate::view {

/// A model that was loaded, and what plays on it.
struct ModelScene {
  std::string name;
  haptics::Model model;
  std::shared_ptr<const haptics::Playback> playback;
  /// The ticks to play: of a trajectory, or of a session. None: the mouse is the tool.
  std::optional<std::vector<FeltTick>> played = {};
  std::string played_words = {};      ///< their description
  bool still = false;                 ///< only pictures are wanted: no thread is started
  std::filesystem::path record = {};  ///< of the mouse's session; empty: none
  std::string session = {};           ///< for the record
};

/// A model under the tool.
[[nodiscard]] std::unique_ptr<View> make_model_view(ModelScene scene);

}  // namespace palpate::view
