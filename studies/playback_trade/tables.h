// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::bench {

// Each prints one table of docs/trade-playback.md in Markdown.

/// Residuals after jumps, by friction, length of the jump and object.
void print_residuals(int jumps);
/// Slips after jumps that end off the cone, by cause: the results of a search of all places around
/// them.
void print_missed_slips(int jumps);
/// Costs and benefits of the tolerance of a slip.
void print_tolerances();
/// The rules of the contact's motion, on each object (thesis 5.4.2, Figure 5.6).
void print_rules(int ticks);
/// Energy that loops return, and the cost of limiting it.
void print_energy(int loops, int jumps);
/// Contacts that are lost while the tool is inside: random touching of the hand for a time [s].
void print_falls(double seconds);
/// The same, energy, residuals and changes of the force on V grooves.
void print_creases(int loops, int jumps, double seconds);
/// The force on one of two tools against that on a tool alone, by their distance.
void print_near_tools();
/// The force on a ball against that on the probe's ball, by their radii.
void print_tool_radii();

}  // namespace palpate::bench
