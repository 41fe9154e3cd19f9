// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

#include "palpate/haptics/model.h"

namespace palpate::haptics {

// Names in the field document, shared by its writer and its reader. Enumerators are written as
// `to_string` names them.
inline constexpr const char* kFieldFormat = "palpate-model";
inline constexpr int kFieldVersion = 1;
inline constexpr const char* kSurfaceFile = "surface.ply";
inline constexpr std::array kFrictionSources = {FrictionSource::samples,
                                                FrictionSource::other_contacts,
                                                FrictionSource::none, FrictionSource::lower_bound};
inline constexpr std::array kBlendRules = {BlendRule::forces, BlendRule::compliances};
inline constexpr std::array kFitStops = {
    FitStop::accurate,  FitStop::explained, FitStop::unexplained,   FitStop::rigid,
    FitStop::max_bases, FitStop::no_gain,   FitStop::not_converged, FitStop::not_determined};
inline constexpr std::array kFitModes = {FitMode::convex, FitMode::certified, FitMode::local};
inline constexpr std::array kPassivities = {Passivity::convex, Passivity::certified,
                                            Passivity::violated, Passivity::undecided};

}  // namespace palpate::haptics
