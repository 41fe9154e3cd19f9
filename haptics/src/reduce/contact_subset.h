// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// A model with some of the contacts of another, on the same surface. They keep what they learnt
/// from the others. It has no response of the surface.
/// \param kept indices, ascending; at least three.
/// \throws as `geometry::triangulate_contacts`.
[[nodiscard]] Model with_contacts(const Model& model, std::span<const std::size_t> kept);

/// The model on a surface of nearly the same shape, whose edges are split where the weights of
/// contacts need it. Contacts move to the nearest point of the surface; the weights are those of
/// the nearest point of the model's surface, of three contacts. It has no response of the surface.
[[nodiscard]] Model on_surface(Model model, const geometry::TriangleMesh& surface);

}  // namespace palpate::haptics
