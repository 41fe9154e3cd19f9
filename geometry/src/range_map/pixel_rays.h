// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/camera.h"

namespace palpate::geometry {

/// No camera and no range map has more pixels: they are counted in int, and each needs some 100
/// bytes. A file that declares more is damaged.
inline constexpr int kMaxPixels = 1 << 28;

/// `pixel_rays` into existing memory, 2 x (width * height). Precondition: the camera is valid.
void fill_pixel_rays(const Camera& camera,
                     Eigen::Ref<Eigen::Matrix2Xd, 0, Eigen::OuterStride<>> rays);

}  // namespace palpate::geometry
