// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "palpate/haptics/model.h"

namespace palpate::web {

struct PageOptions {
  std::string title;
  /// >= 0. Coefficient of contacts whose friction is unknown.
  double unknown_friction = 0;
};

/// A page in which one presses and drags on a model, in one file that loads nothing.
/// \param page_template page.html, as this folder makes it.
/// \throws InvalidInput if the model cannot be played (`haptics::check_playable`), or if the
/// coefficient is outside its range.
/// \throws FileError if the template is not there, or is none.
[[nodiscard]] std::string model_page(haptics::Model model, const PageOptions& options,
                                     const std::filesystem::path& page_template);

}  // namespace palpate::web
