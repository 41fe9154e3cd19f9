// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <vector>

#include "palpate/require.h"

namespace palpate::apps {

/// Accepts the numbers of a range, and no NaN. The message is that of `require`, after the name of
/// the option: "--tolerance: is -1; it must be > 0".
[[nodiscard]] CLI::Validator within(const Interval& range);

/// Pictures are PNG files.
/// \throws InvalidInput for a name with another ending. Empty paths stand for options that were not
/// given.
void check_pictures(const std::vector<std::filesystem::path>& pictures);

/// \throws InvalidInput if `path` bears the name of the deviations or reasons that `decode` writes
/// beside a range map.
void check_is_depths(const std::filesystem::path& path);

}  // namespace palpate::apps
