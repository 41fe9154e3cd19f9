// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/attribute.h"

namespace palpate::geometry {

/// Returns the attributes of the vertices of a PLY file under the names by which viewers of PLY
/// show them without being told: numbers that are neither normals, colours nor texture coordinates
/// become `scalar_NAME` for CloudCompare, unless they have such a name. The first of them is also
/// added as `quality` in float, which is the one number that MeshLab shows, unless there is one.
/// Lists stay.
[[nodiscard]] Attributes with_viewer_names(Attributes attributes);

}  // namespace palpate::geometry
