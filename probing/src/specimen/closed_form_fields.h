// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/core/require.h"
#include "palpate/probing/closed_form.h"

namespace palpate::probing {

// Calls `visit(name, field, range, unit)` for each field of an object: the one list of what files
// may hold and what is allowed.

template <typename Visit>
void visit_fields(Sheet& sheet, Visit&& visit) {
  visit("tension", sheet.tension, at_least(0).finite(), "N");
  visit("axial", sheet.axial, above(0).finite(), "N");
  visit("support", sheet.support, above(10).finite(), "mm");
  visit("compliance", sheet.compliance, at_least(0).finite(), "mm/N");
  visit("lateral", sheet.lateral, above(0).finite(), "N/mm");
  visit("taper", sheet.taper, at_least(0).below(1), "");
  visit("block", sheet.block, at_least(0).finite(), "N/mm");
  visit("depth", sheet.depth, above(0).finite(), "mm");
  visit("softness", sheet.softness, above(0).finite(), "mm");
  visit("edge", sheet.edge, above(0).finite(), "mm");
  visit("block_low", sheet.block_low, finite(), "mm");
  visit("block_high", sheet.block_high, finite(), "mm");
  visit("friction", sheet.friction, at_least(0).finite(), "");
  visit("friction_variation", sheet.friction_variation, at_least(0).finite(), "");
  visit("tilt", sheet.tilt, at_least(0).at_most(45), "degrees");
  visit("retarded", sheet.retarded, at_least(0).below(1), "");
  visit("retardation_time", sheet.retardation_time, above(0).finite(), "s");
}

template <typename Visit>
void visit_fields(Beam& beam, Visit&& visit) {
  visit("length", beam.length, above(0).finite(), "mm");
  visit("width", beam.width, above(0).finite(), "mm");
  visit("height", beam.height, at_least(0).finite(), "mm");
  visit("shear", beam.shear, at_least(0).finite(), "mm/N");
  visit("pressed", beam.pressed, at_least(0).finite(), "mm/N");
  visit("pressed_force", beam.pressed_force, above(0).finite(), "N");
  visit("coupled", beam.coupled, at_least(0).finite(), "mm/N");
  visit("coupled_force", beam.coupled_force, above(0).finite(), "N");
  visit("local_variation", beam.local_variation, at_least(0).below(1), "");
  visit("bending", beam.bending, at_least(0).finite(), "mm/N");
  visit("sideways", beam.sideways, at_least(0).finite(), "mm/N");
  visit("stretching", beam.stretching, at_least(0).finite(), "mm/N");
  visit("twisting", beam.twisting, at_least(0).finite(), "1/(N mm)");
  visit("friction", beam.friction, at_least(0).finite(), "");
  visit("retarded", beam.retarded, at_least(0).below(1), "");
  visit("retardation_time", beam.retardation_time, above(0).finite(), "s");
}

template <typename Visit>
void visit_fields(ElasticBody& body, Visit&& visit) {
  visit("young_modulus", body.young_modulus, above(0).finite(), "N/mm^2");
  visit("poisson_ratio", body.poisson_ratio, above(-1).at_most(0.5), "");
  visit("tool_radius", body.tool_radius, above(0).finite(), "mm");
  visit("size", body.size, above(0).finite(), "mm");
  visit("friction", body.friction, at_least(0).finite(), "");
  visit("retarded", body.retarded, at_least(0).below(1), "");
  visit("retardation_time", body.retardation_time, above(0).finite(), "s");
}

}  // namespace palpate::probing
