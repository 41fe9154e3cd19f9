// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>

#include "palpate/geometry/left_out_triangulations.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// The model without one contact, of this index. The others keep what they learnt from all
/// contacts. It has no response of the surface, which belongs to all contacts.
/// \param triangulations of the model's contacts, \throws as they do.
[[nodiscard]] Model without_contact(const Model& model,
                                    const geometry::LeftOutTriangulations& triangulations,
                                    std::size_t contact);

}  // namespace palpate::haptics
