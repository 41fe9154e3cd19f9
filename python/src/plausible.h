// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

#include "palpate/probing/acquisition.h"
#include "palpate/sensing/rig_doubts.h"

namespace palpate::python {

/// Warns of suspicious features of measurements, as the command does. The interpreter must be
/// locked. \param source of the measurements, for messages.
/// \throws InvalidInput if they cannot be measurements of an object.
void check_plausible(const std::string& source, const probing::CheckedAcquisition& acquisition);

/// Warns of unlikely features of a camera, a rig or depths, as the command does. The interpreter
/// must be locked. \param source of the camera, rig or depths, for messages.
/// \throws InvalidInput if something is impossible.
void tell_doubts(const std::string& source, const std::vector<sensing::Doubt>& doubts);

}  // namespace palpate::python
