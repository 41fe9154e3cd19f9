// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "shared/aliases.h"

namespace palpate::apps {

/// First part of the demo: makes range maps, meshes and pictures below `output` from training
/// images and frames, and compares them with the truth.
/// \return the figures, one entry per frame.
[[nodiscard]] Json demo_seeing(const fs::path& data, const fs::path& output);

/// Second part of the demo: builds models from the measurements of two sheets, evaluates them
/// against the truth and plays them; writes pictures below `output`.
/// \return the figures, one entry per sheet.
[[nodiscard]] Json demo_feeling(const fs::path& data, const fs::path& output);

/// Third part of the demo: a simulated arm measures a simulated sheet, is stopped half way and
/// continues; a model is fitted and compared with the truth. Writes a report below `output`.
/// \return the figures.
[[nodiscard]] Json demo_probing(const fs::path& data, const fs::path& output);

/// Joins a camera frame and three pictures of the first two parts to pictures/overview.png, which
/// is docs/overview.png of the repository.
void demo_overview(const fs::path& data, const fs::path& output);

}  // namespace palpate::apps
