// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <CLI/CLI.hpp>
#include <filesystem>
#include <utility>
#include <vector>

namespace palpate::apps {

/// Accepts numbers from `range.first` to `range.second`, and no NaN.
[[nodiscard]] CLI::Validator within(std::pair<double, double> range);

/// Pictures are PNG files.
/// \throws InvalidInput for a name with another ending. Empty paths stand for options that were not
/// given.
void check_pictures(const std::vector<std::filesystem::path>& pictures);

/// \throws InvalidInput if `path` bears the name of the deviations or reasons that `decode` writes
/// beside a range map.
void check_is_depths(const std::filesystem::path& path);

}  // namespace palpate::apps
