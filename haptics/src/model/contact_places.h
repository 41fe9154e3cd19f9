// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <vector>

#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// The point of a surface that is nearest to each contact, in the order of the contacts.
/// \param surface that of the model, or one of nearly the same shape.
[[nodiscard]] std::vector<geometry::SurfacePoint> contact_places(
    const Model& model, const geometry::SurfaceQuery& surface);

}  // namespace palpate::haptics
