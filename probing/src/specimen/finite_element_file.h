// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "palpate/probing/specimen.h"

namespace palpate::probing {

// The specimen of a JSON object with "type": "finite_elements".
// Throws FileError naming the member, what is wrong with it, and what would be right.
[[nodiscard]] std::unique_ptr<Specimen> finite_elements_of(const nlohmann::json& members,
                                                           const std::string& source);

}  // namespace palpate::probing
