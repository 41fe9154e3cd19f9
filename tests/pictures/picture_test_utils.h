// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <string>

#include "color_map.h"
#include "palpate/geometry/triangle_mesh.h"
#include "scratch_folder.h"

namespace palpate::pictures {

/// A part of a picture, px, (0, 0) in the upper left corner.
using Region = cv::Rect;

/// The place of an image of 64 x 48 px on a picture, without a few pixels at its frame.
inline const Region kImage(34, 114, 972, 727);

/// Draws into a temporary file; fails if something is printed.
/// \return the picture, RGB.
[[nodiscard]] cv::Mat3b draw_picture(const std::function<void(const std::filesystem::path&)>& draw);

/// Expects two files that are the same byte by byte.
void expect_same_again(const std::function<void(const std::filesystem::path&)>& draw);

/// Expects InvalidInput whose message contains `words`, and no file.
void expect_refused(const std::function<void(const std::filesystem::path&)>& draw,
                    const std::string& words);

/// Expects OutputError, and nothing left, where the folder cannot be made.
void expect_unwritable(const std::function<void(const std::filesystem::path&)>& draw);

[[nodiscard]] Rgb pixel(const cv::Mat3b& picture, int x, int y);

/// The largest difference of a channel.
[[nodiscard]] int color_distance(const Rgb& one, const Rgb& other);

/// Pixels in a region whose colour is nearer to `color` than `tolerance`, 255 there and 0
/// elsewhere.
[[nodiscard]] cv::Mat1b mask_of(const cv::Mat3b& picture, const Rgb& color, int tolerance,
                                const Region& region);

/// [px] mean place of the pixels that a mask holds, in the mask; NaN if it holds none.
[[nodiscard]] Eigen::Vector2d center_of(const cv::Mat1b& mask);

/// The smallest rectangle around the pixels that a mask holds, in the mask; empty if it holds none.
[[nodiscard]] Region box_of(const cv::Mat1b& mask);

/// A flat square of `size` mm that faces a camera at the origin, its corner nearest to the origin
/// at (x, y, z), in 2 x `cells`^2 triangles.
[[nodiscard]] geometry::TriangleMesh make_square(const Eigen::Vector3d& corner, double size,
                                                 int cells);

/// Both, the second's vertices after the first's.
[[nodiscard]] geometry::TriangleMesh join(const geometry::TriangleMesh& one,
                                          const geometry::TriangleMesh& other);

}  // namespace palpate::pictures
