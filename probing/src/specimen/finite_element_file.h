// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "palpate/probing/finite_element_specimen.h"

namespace palpate::probing {

// The solid of a JSON object with "type": "finite_elements".
// Throws FileError naming the member, what is wrong with it, and what would be right.
[[nodiscard]] FiniteElementObject finite_elements_of(const nlohmann::json& members,
                                                     const std::string& source);

}  // namespace palpate::probing
