// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "palpate/haptics/evaluate.h"
#include "palpate/haptics/model.h"
#include "palpate/haptics/playback.h"
#include "palpate/probing/acquisition.h"
#include "shared/aliases.h"

namespace palpate::apps {

/// Contacts (indices) by the errors of their fields, the smallest first.
[[nodiscard]] std::vector<std::size_t> contacts_by_error(const haptics::Model& model);
/// The contact with the median error, for a representative picture.
[[nodiscard]] std::size_t median_contact(const haptics::Model& model);

/// Draws a model's surface, the geodesic Voronoi cells of its contacts, and their triangulation.
void draw_model_contacts(const fs::path& png, const haptics::Model& model,
                         const std::string& title);

/// Draws the realigned samples of one contact (an index) with its field and friction cone, in the
/// contact's local frame.
void draw_contact_field(const fs::path& png, const haptics::Model& model,
                        const probing::CheckedAcquisition& acquisition, std::size_t contact);

/// Draws the leave-one-out errors of contacts on the surface, interpolated between contacts by
/// their weights; they are unknown where no contact has influence.
void draw_leave_one_out(const fs::path& png, const haptics::Model& model,
                        const haptics::LeaveOneOut& errors);

/// Draws the forces of a played trace.
void draw_trace(const fs::path& png, std::span<const haptics::TracePoint> trace,
                const std::string& title);

}  // namespace palpate::apps
