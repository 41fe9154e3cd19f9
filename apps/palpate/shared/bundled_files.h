// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "shared/aliases.h"

namespace palpate::apps {

/// The folder of this program.
/// \throws FileError if /proc is not mounted.
[[nodiscard]] fs::path program_folder();

/// A file or folder that comes with the command.
/// \param installed its path relative to the folder of the command, \param in_build where it is
/// when the command runs in the folder in which it was built.
/// \throws FileError if there is none, and as `program_folder`.
[[nodiscard]] fs::path bundled(const fs::path& installed, const fs::path& in_build);

}  // namespace palpate::apps
