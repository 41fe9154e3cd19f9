// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

// Closed forms of a rigid ball that is dragged over an elastic half-space by less than friction
// holds (Johnson, Contact Mechanics, 7.2 and 7.4).
namespace palpate::bench {

struct MindlinContact {
  double limit = 0;       // [N] friction coefficient times normal force
  double compliance = 0;  // [mm^2/N] (2 - nu) / G
  double radius = 0;      // [mm] of the contact
};

// [mm] Under a tangential force of `part` of the limit, the first after pressing.
[[nodiscard]] double mindlin_displacement(const MindlinContact& contact, double part);

// [N mm] Energy lost per cycle of the tangential force between +-`part` of the limit, by slip in
// the outer ring of the contact, while its middle sticks.
[[nodiscard]] double mindlin_loss(const MindlinContact& contact, double part);

}  // namespace palpate::bench
