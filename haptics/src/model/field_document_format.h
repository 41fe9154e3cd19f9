// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>

namespace palpate::haptics {

// Words of the field document, which its writer and its reader share.
inline constexpr const char* kFieldFormat = "palpate-model";
/// Version 1 has one epsilon for all bases of a contact, which are isotropic, and the weights of
/// the surface's vertices in the document. Version 2 has frames as matrices, friction axes as unit
/// vectors, and ridges among the bases, each with an epsilon and a center and along a unit vector.
inline constexpr int kFieldVersion = 3;
inline constexpr const char* kSurfaceFile = "surface.ply";
inline constexpr std::array<const char*, 4> kFrictionSources = {"samples", "other_contacts", "none",
                                                                "lower_bound"};
inline constexpr std::array<const char*, 2> kBlendRules = {"forces", "compliances"};

}  // namespace palpate::haptics
