// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>

#include "export/export_page.h"

namespace palpate::apps {

/// Writes meshes with the same triangles, as `track` writes them, as one animated surface.
/// \param rate [Hz] frames per second; none: those of the names, or a usual one.
/// \returns what was written, in words: frames, duration, size, and frames that `track` lost.
std::string write_animation(const PageCall& page, const fs::path& output,
                            const std::optional<double>& rate);

}  // namespace palpate::apps
