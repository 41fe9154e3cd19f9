// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace palpate::apps {

/// First part of the demo: makes range maps, meshes and pictures below `output` from training
/// images and frames, and compares them with the truth.
/// \return the figures, one entry per frame.
[[nodiscard]] nlohmann::ordered_json demo_seeing(const std::filesystem::path& data,
                                                 const std::filesystem::path& output);

/// Second part of the demo: builds models from the measurements of two sheets, evaluates them
/// against the truth and plays them; writes pictures below `output`.
/// \return the figures, one entry per sheet.
[[nodiscard]] nlohmann::ordered_json demo_feeling(const std::filesystem::path& data,
                                                  const std::filesystem::path& output);

/// Third part of the demo: a simulated arm measures a simulated sheet, is stopped half way and goes
/// on; then a model is fitted and compared with the truth. Writes a report below `output`.
/// \return the figures.
[[nodiscard]] nlohmann::ordered_json demo_probing(const std::filesystem::path& data,
                                                  const std::filesystem::path& output);

/// Joins a camera frame and three pictures of the first two parts to pictures/overview.png, which
/// is docs/overview.png of the repository.
void demo_overview(const std::filesystem::path& data, const std::filesystem::path& output);

}  // namespace palpate::apps
