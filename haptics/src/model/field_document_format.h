// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

// Names in the field document, shared by its writer and its reader. Enumerators are written as
// `to_string` names them.
inline constexpr const char* kFieldFormat = "palpate-model";
inline constexpr const char* kSurfaceFile = "surface.ply";
inline constexpr std::array kFrictionSources = {FrictionSource::samples,
                                                FrictionSource::other_contacts,
                                                FrictionSource::none, FrictionSource::lower_bound};
inline constexpr std::array kTriangulations = {geometry::ContactTriangulationMethod::delaunay,
                                               geometry::ContactTriangulationMethod::voronoi_dual};
inline constexpr std::array kBlendRules = {BlendRule::forces, BlendRule::compliances};
inline constexpr std::array kFitStops = {
    FitStop::accurate,  FitStop::explained, FitStop::unexplained,   FitStop::rigid,
    FitStop::max_bases, FitStop::no_gain,   FitStop::not_converged, FitStop::not_determined};
inline constexpr std::array kFitModes = {FitMode::convex, FitMode::certified, FitMode::local};
inline constexpr std::array kPassivities = {Passivity::convex, Passivity::certified,
                                            Passivity::violated, Passivity::undecided};

/// Returns true if a text is one that `probing::fingerprint` may return.
[[nodiscard]] inline bool is_fingerprint(std::string_view text) {
  constexpr std::size_t kDigits = 16;
  return text.size() == kDigits &&
         text.find_first_not_of("0123456789abcdef") == std::string_view::npos;
}

}  // namespace palpate::haptics
