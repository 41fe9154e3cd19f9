// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/model.h"

namespace palpate::haptics {

// Entries of `Model::made` that the library itself reads again.

/// The `probing::fingerprint` of the acquisition that a model was fitted to.
inline constexpr const char* kSamplesFingerprint = "samples_fingerprint";

/// The method by which the contacts were triangulated, as `to_string` names it.
inline constexpr const char* kTriangulation = "triangulation";

/// The offsets that were found in an acquisition that was only pressed.
inline constexpr const char* kPressingOffsets = "pressing_offsets";

/// The method that `made` names; `delaunay` if it names none.
[[nodiscard]] inline geometry::ContactTriangulationMethod triangulation_method(const Model& model) {
  using geometry::ContactTriangulationMethod;
  const auto found = model.made.find(kTriangulation);
  const bool by_dual = found != model.made.end() &&
                       found->second == to_string(ContactTriangulationMethod::voronoi_dual);
  return by_dual ? ContactTriangulationMethod::voronoi_dual : ContactTriangulationMethod::delaunay;
}

}  // namespace palpate::haptics
