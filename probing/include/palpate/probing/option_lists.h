// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "palpate/core/fields.h"

namespace palpate::probing {

/// Visits the lists of all options of this library, with their defaults.
void visit_options(FieldVisitor& visitor);

}  // namespace palpate::probing
