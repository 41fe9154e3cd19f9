// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "scene.h"

namespace palpate::bench {

/// Scenes in front of rigs of other shapes than the bundled one, with patterns that are designed
/// for them: a projector that is turned towards the object, and one whose sinusoid runs along the
/// columns. Smooth and folded sheets, balls, coloured walls, small and hardly any objects.
[[nodiscard]] std::vector<Scene> scenes_of_other_rigs();

}  // namespace palpate::bench
