// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "palpate/haptics/model.h"
#include "reduce/strokes.h"

namespace palpate::haptics {

/// Some contacts of a model that predict the others.
struct ThinnedContacts {
  std::vector<std::size_t> kept;  ///< indices, ascending
  Model model;                    ///< `with_contacts` of them
  double error = 0;               ///< [N] RMS difference from the model at the ends of the strokes
};

/// Chooses few contacts with which strokes feel as with all of them. It begins with a few that
/// cover the object, and adds those at which the difference is largest, some at a time and never
/// two neighbours, until it is at most `error`, or there are no more. Contacts around the
/// candidates come last: they keep the triangles of the candidates as they are.
/// \param candidates indices, ascending; at least three.
/// \param ends of the strokes, as the model plays them. \param tried is called after each model.
[[nodiscard]] ThinnedContacts thin_contacts(const Model& model,
                                            std::span<const std::size_t> candidates,
                                            std::span<const Stroke> strokes,
                                            std::span<const StrokeEnd> ends, double error,
                                            const std::function<void()>& tried);

}  // namespace palpate::haptics
