// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace palpate::apps {

/// The first half of the demo: training images and frames become range maps, meshes and pictures
/// below `output`, measured against the truth.
/// \return the figures, one entry a frame.
[[nodiscard]] nlohmann::ordered_json demo_seeing(const std::filesystem::path& data,
                                                 const std::filesystem::path& output);

}  // namespace palpate::apps
