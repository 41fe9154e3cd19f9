// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>

#include "palpate/probing/specimen.h"

namespace palpate::python {

/// A simulated object, and the text that it was made of.
struct Specimen {
  std::shared_ptr<const probing::Specimen> object;
  std::string text;
};

/// \throws FileError naming `source`, as `parse_specimen` does.
[[nodiscard]] Specimen new_specimen(const std::string& text, const std::string& source);

}  // namespace palpate::python
