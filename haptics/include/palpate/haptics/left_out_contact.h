// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/model.h"

namespace palpate::haptics {

/// The model without one contact: the other contacts are triangulated again, by the method that the
/// model was made with, and their compliances are computed again (thesis 5.3.3).
///
/// \param points of all contacts of the model on its surface
/// \param index of the contact that is left out
/// \throws InvalidInput if there is not one point for each contact, if there is no such contact, or
/// if the others cannot be triangulated.
[[nodiscard]] Model without_contact(const Model& model, std::vector<geometry::SurfacePoint> points,
                                    std::size_t index);

/// Which contacts lie at the border of the triangulation of contacts: on an edge of one triangle
/// only. In the order of the model's contacts.
[[nodiscard]] std::vector<bool> border_contacts(const Model& model);

}  // namespace palpate::haptics
