// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "palpate/haptics/model.h"

namespace palpate::apps {

/// A page in which one presses and drags on a model, in one file that loads nothing.
/// \throws FileError if the page's template, which is installed with the command, is not there.
[[nodiscard]] std::string model_page(const haptics::Model& model, const std::string& title);

}  // namespace palpate::apps
