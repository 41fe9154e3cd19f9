// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace palpate::apps {

/// The second half of the demo: the measurements of two sheets become models, which are evaluated
/// against the truth and played; pictures below `output`.
/// \return the figures, one entry a sheet.
[[nodiscard]] nlohmann::ordered_json demo_feeling(const std::filesystem::path& data,
                                                  const std::filesystem::path& output);

}  // namespace palpate::apps
