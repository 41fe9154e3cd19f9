// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace palpate::sensing {

/// The line, counted from 1, at which something follows the first document of a YAML text: after a
/// line that begins with `...` or a second `---`, or after a bracket that closes more than was
/// opened. Nothing for a single document, and for a text that does not begin with %YAML.
[[nodiscard]] std::optional<std::size_t> second_yaml_document(std::string_view text);

}  // namespace palpate::sensing
