// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "command_line.h"

#include <iostream>
#include <nlohmann/json.hpp>

namespace palpate::apps {

void print(const Settings& settings, const nlohmann::ordered_json& figures,
           const std::string& prose) {
  std::cout << (settings.json ? figures.dump(2) : prose) << '\n';
}

}  // namespace palpate::apps
