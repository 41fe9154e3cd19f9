// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/attribute.h"

namespace palpate::geometry {

/// Converts PCL's field names to ours: normal_x becomes nx, and the bytes of rgb (of which the
/// highest has no meaning) and rgba become red, green, blue and alpha.
[[nodiscard]] Attributes from_pcd_fields(Attributes fields);

/// The inverse: nx becomes normal_x; colours are packed iff all of them are bytes.
[[nodiscard]] Attributes to_pcd_fields(Attributes attributes);

}  // namespace palpate::geometry
