// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "palpate/probing/finite_element_specimen.h"
#include "palpate/probing/specimen.h"

namespace palpate::probing {

/// Makes a specimen from a JSON object such as
///
///     {"type": "sheet", "tension": 0.8, "block": 1.5, "block_low": [5, -20]}
///
/// `type` is sheet, beam, elastic_body or finite_elements. The other members of the first three are
/// the fields of the structs in closed_form.h, with their defaults. docs/probing.md describes all.
/// \param source names the text in messages.
/// \throws FileError naming the member, what is wrong with it, and what would be right.
[[nodiscard]] std::unique_ptr<Specimen> parse_specimen(const std::string& text,
                                                       const std::string& source);

/// The solid of such an object with the type finite_elements.
/// \throws FileError as `parse_specimen` does, and if the type is another one.
[[nodiscard]] FiniteElementObject parse_finite_elements(const std::string& text,
                                                        const std::string& source);

}  // namespace palpate::probing
