// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "shared/bundled_files.h"

#include <string>
#include <system_error>

#include "palpate/core/error.h"

namespace palpate::apps {

fs::path program_folder() {
  constexpr const char* kProgram = "/proc/self/exe";
  std::error_code error;
  const fs::path program = fs::read_symlink(kProgram, error);
  if (error) {
    throw FileError(std::string(kProgram) + ": cannot be read (" + error.message() +
                    "); mount /proc, so that Palpate finds its files");
  }
  return program.parent_path();
}

fs::path bundled(const fs::path& installed, const fs::path& in_build) {
  const fs::path path = program_folder() / installed;
  if (fs::exists(path)) return fs::canonical(path);
  if (fs::exists(in_build)) return in_build;
  throw FileError(path.string() + ": this part of the installation is missing; install it again");
}

}  // namespace palpate::apps
