// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

namespace palpate::apps {

/// A text that differs, in all likelihood, where the content of files does.
[[nodiscard]] std::string fingerprint(const std::filesystem::path& file);

}  // namespace palpate::apps
