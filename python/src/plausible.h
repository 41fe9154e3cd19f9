// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

#include "palpate/probing/acquisition.h"

namespace palpate::python {

/// Warns of what is suspicious about measurements, as the command does. The interpreter must be
/// locked. \param source what gave the measurements, for messages.
/// \throws InvalidInput if they cannot be measurements of an object.
void check_plausible(const std::string& source, const probing::CheckedAcquisition& acquisition);

}  // namespace palpate::python
