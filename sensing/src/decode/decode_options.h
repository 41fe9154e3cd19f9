// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/sensing/decode.h"

namespace palpate::sensing {

/// \throws InvalidInput if an anchor is not in the image or in front of the camera, if the pattern
/// has stripes and there are anchors, or if it has neither.
void check_anchors(const std::vector<Anchor>& anchors, const Pattern& pattern,
                   const geometry::Camera& camera);

/// The rig whose camera has the size of the decoded image.
/// \throws InvalidInput if the sinusoid is too fine for half the size.
[[nodiscard]] Rig decoded_rig(const Rig& rig, const Pattern& pattern, bool half);

}  // namespace palpate::sensing
