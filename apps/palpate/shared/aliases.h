// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace palpate::apps {

namespace fs = std::filesystem;

/// JSON whose members stay in the order in which they were added.
using Json = nlohmann::ordered_json;

}  // namespace palpate::apps
