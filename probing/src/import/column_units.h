// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/probing/acquisition_mapping.h"

namespace palpate::probing {

/// Compares units in the names of columns, such as "Fz (mN)" or "X [m]", with those of the mapping.
/// \throws InvalidInput naming the column, its unit and what would be right, if they differ.
void check_units_of_names(const AcquisitionMapping& mapping);

}  // namespace palpate::probing
