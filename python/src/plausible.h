// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "palpate/probing/acquisition.h"
#include "palpate/sensing/rig_doubts.h"

namespace palpate::python {

/// Warns of what is suspicious about measurements, as the command does. The interpreter must be
/// locked. \param source what gave the measurements, for messages.
/// \throws InvalidInput if they cannot be measurements of an object.
void check_plausible(const std::string& source, const probing::CheckedAcquisition& acquisition);

/// Warns of what is unlikely about a camera, a rig or depths, as the command does. The interpreter
/// must be locked. \param source what they belong to, for messages.
/// \throws InvalidInput if something is impossible.
void tell_doubts(const std::string& source, const std::vector<sensing::Doubt>& doubts);

}  // namespace palpate::python
