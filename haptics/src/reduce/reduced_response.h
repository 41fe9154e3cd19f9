// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// The response of a model's surface for another surface of nearly the same shape, with some of the
/// contacts. Vertices follow the nodes that the nearest place of the model's surface follows.
/// \param model has a response. \param kept indices of contacts, ascending.
[[nodiscard]] SurfaceResponse reduced_response(const Model& model,
                                               const geometry::TriangleMesh& surface,
                                               std::span<const std::size_t> kept);

}  // namespace palpate::haptics
