// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// The parts of the validation; each prints its lines of the table.
namespace palpate::bench {

// A ball without friction on a half-space, and what makes it differ from Hertz.
void compare_with_hertz();
// A ball dragged with friction: Cattaneo's and Mindlin's displacement, and the energy that Mindlin
// and Deresiewicz expect a cycle to lose.
void compare_with_mindlin();
// A flat round punch that sticks, and a sticking ball: `HalfSpaceModel`.
void compare_with_half_space_model();
// The energy that a tip loses on closed ways while all of its points stick.
void measure_sticking_loops();
// The same forces on meshes of which one is twice as fine.
void compare_with_halved_mesh();
// The tangential force at which a ball slides, whose points slip by Coulomb's law.
void measure_slides();
// 1000 ways of a tip, by the stop with which they ended.
void count_random_paths();
// Three solids in large deformation, also computed by CalculiX (the program `ccx`).
void compare_with_calculix();

}  // namespace palpate::bench
