// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/geometry/attribute.h"

namespace palpate::geometry {

/// From PCL's names of fields to ours: normal_x becomes nx, and the bytes of rgb (of which the
/// highest has no meaning) and rgba become red, green, blue and alpha.
[[nodiscard]] Attributes from_pcd_fields(Attributes fields);

/// And back: nx becomes normal_x; colours are packed iff all are bytes.
[[nodiscard]] Attributes to_pcd_fields(Attributes attributes);

}  // namespace palpate::geometry
