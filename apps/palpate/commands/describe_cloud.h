// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "commands/describe_mesh.h"
#include "palpate/geometry/mesh_io.h"

namespace palpate::apps {

/// Describes points: how many, where, how far from each other, and what is known of each.
[[nodiscard]] Description describe_cloud(const geometry::PointCloud& cloud);

}  // namespace palpate::apps
