// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>

#include "repository.h"
#include "scratch_folder.h"

namespace palpate::sensing {

/// Writes a file into a folder and returns its path.
inline std::filesystem::path written(const ScratchFolder& folder, const std::string& name,
                                     const std::string& bytes) {
  write_text(folder / name, bytes);
  return folder / name;
}

inline std::filesystem::path demo_path(const std::string& name) {
  return repository("demo") / name;
}

/// The message of the exception of type E that `call` throws; empty if it throws nothing.
template <typename E, typename Call>
std::string message_of(const Call& call) {
  try {
    call();
  } catch (const E& error) {
    return error.what();
  }
  return {};
}

}  // namespace palpate::sensing
