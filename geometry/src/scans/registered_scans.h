// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "palpate/geometry/merge_scans.h"

namespace palpate::geometry {

/// Name of a scan in messages of `caller`: its own name, or "merge_scans: scan 3".
[[nodiscard]] std::string scan_name(std::span<const Scan> scans, std::size_t i,
                                    const std::string& caller);

/// Transforms the scans to the frame of the object.
/// \throws InvalidInput naming `caller` and the scan if there is none, one is not valid or its pose
/// is not rigid and finite.
[[nodiscard]] std::vector<TriangleMesh> in_frame_of_object(std::span<const Scan> scans,
                                                           const std::string& caller);

/// \throws InvalidInput naming `caller` and the scan if one is not manifold or not oriented.
void require_manifold(std::span<const Scan> scans, const std::string& caller);

/// [mm] point spacing of scans: their median edge length.
/// \throws InvalidInput naming `caller` if it is 0.
[[nodiscard]] double median_edge_length(const std::vector<TriangleMesh>& meshes,
                                        const std::string& caller);

}  // namespace palpate::geometry
