// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/bundled_files.h"

#include "palpate/core/error.h"

namespace palpate::apps {

namespace fs = std::filesystem;

fs::path bundled(const fs::path& installed, const fs::path& in_build) {
  const fs::path path = fs::read_symlink("/proc/self/exe").parent_path() / installed;
  if (fs::exists(path)) return fs::canonical(path);
  if (fs::exists(in_build)) return in_build;
  throw FileError(path.string() + ": this part of the installation is missing; install it again");
}

}  // namespace palpate::apps
