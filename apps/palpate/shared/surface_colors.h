// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <opencv2/core/mat.hpp>

#include "palpate/geometry/mesh_io.h"
#include "palpate/geometry/range_map.h"
#include "shared/map_camera.h"

namespace palpate::apps {

/// Returns the colours of vertices: those of `color` at their places in the image. Vertices beyond
/// the image take the nearest pixel's.
/// \param vertices 3 x V [mm], camera frame
/// \param color 8 bit, BGR or grey, of the camera's size
[[nodiscard]] geometry::Attributes colors_of(const Eigen::Matrix3Xd& vertices,
                                             const geometry::Camera& camera, const cv::Mat& color);

/// The points of a range map as an organised cloud: one per pixel, NaN where unknown.
/// \param color as above, or empty for none
[[nodiscard]] geometry::PointCloud organised_cloud(const geometry::RangeMap& map,
                                                   const cv::Mat& color);

/// The picture that `decode --surface-color` writes beside a range map.
[[nodiscard]] fs::path color_beside(const fs::path& range_map);

/// Colours of the vertices of a range map's mesh, from the picture that `decode --surface-color`
/// has written beside the range map.
/// \param vertices 3 x V [mm], camera frame
/// \throws FileError if the picture is missing, or does not have the size of the range map.
[[nodiscard]] geometry::Attributes colors_beside(const fs::path& range_map,
                                                 const Eigen::Matrix3Xd& vertices,
                                                 const MapCamera& camera);

/// The picture of a range map NAME in a folder: NAME_color.png, as `decode --surface-color` writes
/// it, or NAME.png, NAME.jpg or NAME.tiff, which is not the range map itself; or, if the folder
/// belongs to a recording (`is_depth_recording`), the picture that was taken with the depth image.
/// \throws FileError if there is none.
[[nodiscard]] fs::path picture_of(const fs::path& folder, const fs::path& range_map,
                                  const MapCamera& camera);

/// Colours of the vertices of a range map's mesh, from its picture in a folder.
/// \param vertices 3 x V [mm], camera frame
/// \throws FileError if there is none, or if it does not have 8 bit and the range map's size.
[[nodiscard]] geometry::Attributes colors_in(const fs::path& folder, const fs::path& range_map,
                                             const Eigen::Matrix3Xd& vertices,
                                             const geometry::Camera& seen_by,
                                             const MapCamera& camera);

/// Intensities of a range map's pixels, from its picture in a folder: of colours, the mean of the
/// channels.
/// \throws FileError if there is none, or if it does not have the size of the range map.
[[nodiscard]] geometry::ImageF intensities_in(const fs::path& folder, const fs::path& range_map,
                                              const geometry::Camera& seen_by,
                                              const MapCamera& camera);

}  // namespace palpate::apps
