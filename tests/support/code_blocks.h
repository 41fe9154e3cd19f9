// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "repository.h"
#include "scratch_folder.h"

namespace palpate {

/// The code blocks of a page of the repository that are marked as `language`.
inline std::vector<std::string> code_blocks(const std::string& page, const std::string& language) {
  const std::string text = read_text(repository(page));
  const std::string begin = "\n```" + language + "\n";
  std::vector<std::string> blocks;
  for (std::size_t at = text.find(begin); at != std::string::npos; at = text.find(begin, at)) {
    at += begin.size();
    blocks.push_back(text.substr(at, text.find("```", at) - at));
  }
  return blocks;
}

}  // namespace palpate
