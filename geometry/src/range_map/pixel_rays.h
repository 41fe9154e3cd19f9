// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>

#include "palpate/geometry/camera.h"

namespace palpate::geometry {

/// `pixel_rays` into existing memory, 2 x (width * height). Precondition: the camera is valid.
void fill_pixel_rays(const Camera& camera,
                     Eigen::Ref<Eigen::Matrix2Xd, 0, Eigen::OuterStride<>> rays);

}  // namespace palpate::geometry
