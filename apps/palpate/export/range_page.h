// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "shared/map_camera.h"

namespace palpate::apps {

/// Writes a page that shows range maps, or depth images, of one camera: depths, and the predicted
/// deviations and reasons that `decode` has written beside them.
/// \returns what was written, in words: frames, size, and what rounding has lost.
/// \throws FileError if a file is damaged or there is no camera; InvalidInput if sizes differ, no
/// pixel is known, or the page would be too long. Nothing is written then.
std::string write_range_page(const fs::path& output, const std::vector<fs::path>& maps,
                             const MapCamera& camera, const std::string& title);

}  // namespace palpate::apps
