// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "whole/version.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <sstream>

#include "commit.h"
#include "palpate/haptics/model_io.h"
#include "palpate/probing/campaign_store.h"
#include "shared/aliases.h"

namespace palpate::apps {
namespace {

// From "NAME VERSION, NAME VERSION".
Json versions_of_libraries() {
  Json versions;
  std::istringstream list(PALPATE_LIBRARIES);
  std::string name, version;
  while (list >> name >> version) versions[name] = version.substr(0, version.find(','));
  return versions;
}

}  // namespace

std::string version_text(bool json) {
  if (json) {
    const Json figures = {
        {"version", PALPATE_VERSION},
        {"commit", PALPATE_COMMIT},
        {"licence", PALPATE_LICENCE},
        {"compiler", PALPATE_COMPILER},
        {"formats",
         {{"field.json", haptics::kFieldVersion}, {"acquisition.db", probing::kStoreVersion}}},
        {"libraries", versions_of_libraries()}};
    return figures.dump(2);
  }
  return fmt::format(
      "palpate {}\ncommit: {}\nlicence: {}\ncompiler: {}\nformats: field.json {}, acquisition.db "
      "{}\n"
      "libraries: {}",
      PALPATE_VERSION, PALPATE_COMMIT, PALPATE_LICENCE, PALPATE_COMPILER, haptics::kFieldVersion,
      probing::kStoreVersion, PALPATE_LIBRARIES);
}

}  // namespace palpate::apps
