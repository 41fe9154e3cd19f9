// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"

namespace palpate::geometry {

/// The points of a range map as an organised cloud in the camera frame [mm]: those of
/// `back_project`, one per pixel, NaN where the depth is unknown.
/// \param sigma [mm] standard deviations of the depths, which become the attribute `sigma`; of the
/// size of the range map, or empty for none.
/// \throws InvalidInput as `back_project`, or if `sigma` has another size.
[[nodiscard]] PointCloud organised_cloud(const RangeMap& map, const ImageF& sigma = {});

/// The range map of an organised cloud in the frame of `camera`, the inverse of `organised_cloud`:
/// depths are the Z of the points, rounded to float, and NaN where a point is not finite or not in
/// front of the camera.
/// \throws InvalidInput if the camera is not valid or not of the size of the cloud, or if a point is
/// not where its pixel sees it, within half a pixel.
[[nodiscard]] RangeMap range_map_of(const PointCloud& cloud, const Camera& camera);

/// The camera without lens distortion that sees the points of an organised cloud at their pixels,
/// in the least squares of pixels. `range_map_of` tells whether there is one.
/// \throws InvalidInput if the cloud is not organised, if the points in front of the camera do not
/// determine it, or if the cloud is mirrored: X points to lower columns, or Y to lower rows.
[[nodiscard]] Camera fitted_camera(const PointCloud& cloud);

}  // namespace palpate::geometry
