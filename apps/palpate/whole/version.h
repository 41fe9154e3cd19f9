// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate::apps {

/// What `palpate --version` prints: version, commit, licence, compiler and libraries of this
/// program; "+" behind the commit tells that files were changed.
[[nodiscard]] std::string version_text(bool json);

}  // namespace palpate::apps
