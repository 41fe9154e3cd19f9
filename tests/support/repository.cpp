// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "repository.h"

namespace palpate {

std::filesystem::path repository(const std::filesystem::path& path) {
  return std::filesystem::path(PALPATE_SOURCE_DIR) / path;
}

}  // namespace palpate
