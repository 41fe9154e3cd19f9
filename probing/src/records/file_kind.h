// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <optional>
#include <string_view>

namespace palpate::probing {

/// [bytes] of the start of a file that `other_than_text` looks at.
inline constexpr std::size_t kFileStart = 512;

/// Describes a file that begins like this, and how it becomes a text file with one table; nothing
/// if it may be one.
[[nodiscard]] std::optional<std::string_view> other_than_text(std::string_view start);

}  // namespace palpate::probing
