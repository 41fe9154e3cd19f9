// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "image/image_plane.h"

namespace palpate::sensing {

/// Finds the pixels where any channel is at full scale.
void find_clipped(const std::vector<Plane>& channels, Mask& clipped);

}  // namespace palpate::sensing
