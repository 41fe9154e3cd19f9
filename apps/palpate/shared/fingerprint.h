// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

#include "shared/aliases.h"

namespace palpate::apps {

/// Returns a text that almost certainly differs if the content of the files differs.
[[nodiscard]] std::string fingerprint(const fs::path& file);

/// Returns the fingerprint of a file with this content.
[[nodiscard]] std::string fingerprint_of(std::string_view text);

}  // namespace palpate::apps
