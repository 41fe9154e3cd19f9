// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace palpate::apps {

/// Returns the output of `palpate --version`: version, commit, licence, compiler, versions of
/// its own file formats, and libraries of this program; "+" after the commit means that files were
/// changed.
[[nodiscard]] std::string version_text(bool json);

}  // namespace palpate::apps
