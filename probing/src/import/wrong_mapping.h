// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "palpate/core/error.h"

namespace palpate::probing {

/// A member of a mapping that cannot be right: "AcquisitionMapping::columns: ...".
[[nodiscard]] inline InvalidInput wrong_mapping(const std::string& member,
                                                const std::string& problem) {
  return InvalidInput(
      std::vector<MessagePart>{{"AcquisitionMapping::" + member, true}, {": " + problem}});
}

}  // namespace palpate::probing
