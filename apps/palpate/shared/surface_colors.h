// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"

namespace palpate::apps {

/// Colours of vertices: what `color` shows where the camera sees them. Vertices beyond the image
/// take the nearest pixel's.
/// \param vertices 3 x V [mm], camera frame
/// \param color 8 bit, BGR or grey, of the camera's size
[[nodiscard]] geometry::Attributes colors_of(const Eigen::Matrix3Xd& vertices,
                                             const geometry::Camera& camera, const cv::Mat& color);

/// The points of a range map as an organised cloud: one per pixel, NaN where unknown.
/// \param color as above, or empty for none
[[nodiscard]] geometry::PointCloud organised_cloud(const geometry::RangeMap& map,
                                                   const cv::Mat& color);

}  // namespace palpate::apps
