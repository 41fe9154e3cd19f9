// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace palpate::apps {

/// A text that almost certainly differs if the content of the files differs.
[[nodiscard]] std::string fingerprint(const std::filesystem::path& file);

}  // namespace palpate::apps
