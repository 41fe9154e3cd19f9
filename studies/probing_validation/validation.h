// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::bench {

/// Approaches to objects of eight stiffnesses: place and force of the touch, and the rule of thesis
/// 4.4.1 on the same objects.
void validate_touches(int runs);

/// Slip decisions: simulated trials with microslip, and trials of the virtual arm on specimens.
void validate_slips(int trials);

/// Table 4.1 of the thesis with the virtual arm: errors of the force with gravity compensated only,
/// with the internal force of the approach, and with friction that follows the joints.
void validate_forces();

/// Faults of an arm while its tip swings.
void validate_faults(unsigned seeds);

}  // namespace palpate::bench
