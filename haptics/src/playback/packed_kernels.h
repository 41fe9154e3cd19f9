// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/haptics/packed_field.h"

namespace palpate::haptics::packed {

// Offsets of the constants of a contact.
constexpr int kPressing = 0;         // pressing frame, by columns
constexpr int kCone = 9;             // axis of the friction cone
constexpr int kPosition = 12;        //
constexpr int kAxis = 15;            // friction axis
constexpr int kFriction = 18;        //
constexpr int kValues = 19;          // compliance
constexpr int kRoot = 25;            // square root of det c
constexpr int kInverseRoot = 26;     //
constexpr int kInverseDepth = 27;    // 1 / u_z
constexpr int kTrend = 28;           // row by row
constexpr int kGradientAtZero = 58;  // of the sum of bases alone, without its linear part
constexpr int kEnergyAtZero = 61;    // the same
constexpr int kLoadExponent = 62;    // of the friction
static_assert(kLoadExponent + 1 == PlaceField::kConstants);

/// The bases of all contacts.
struct Bases {
  const PackedField::IsotropicBases* isotropic;
  const PackedField::RidgeBases* ridges;
  const PackedField::BaseRange* ranges;
};

// Each has one version with AVX2 and one without, chosen at run time, which give the same bits.

/// Force in the world (3) and energy at a displacement in the world (3).
void evaluate(const PlaceField& place, const Bases& bases, const double* displacement,
              Lanes& result) noexcept;

/// Gradient (3) and energy of a contact's bases at x (3), summed as `evaluate` does.
void evaluate_bases(const Bases& bases, int contact, const double* x, Lanes& result) noexcept;

/// Blends the contacts of a place. False where the closed form does not hold.
/// \param position [mm] (3). \param reach [mm] as in `Model`. \param weights of the contacts.
bool blend_places(const double* position, double reach, const Lanes* weights,
                  PlaceField& place) noexcept;

}  // namespace palpate::haptics::packed
