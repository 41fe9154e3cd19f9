// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>

namespace palpate::geometry {

/// The ending that a file of this content has: ".ply", ".pcd", ".off", ".stl", ".glb" or ".obj"; ""
/// if it is none of these.
[[nodiscard]] std::string ending_by_content(std::string_view content);

}  // namespace palpate::geometry
