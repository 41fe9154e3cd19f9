// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "palpate/probing/acquisition.h"
#include "palpate/probing/contact_surface.h"

namespace palpate::apps {

/// Prints a warning on standard error, and adds it to the list `warnings` of a command's figures:
/// {"kind": ..., "message": ...}.
void warn(nlohmann::ordered_json& warnings, const std::string& kind, const std::string& message);

/// Warns of what is suspicious in measurements.
/// \throws InvalidInput if they cannot be measurements of an object, naming `source`.
void check_plausible(const std::string& source, const probing::CheckedAcquisition& acquisition,
                     nlohmann::ordered_json& warnings);

/// Warns of contacts that a surface of contacts is made without.
void tell_left_out(const probing::ContactSurface& surface, nlohmann::ordered_json& warnings);

/// Reads and checks a store.
/// \throws FileError, or InvalidInput if it cannot hold measurements of an object.
[[nodiscard]] probing::CheckedAcquisition read_plausible_acquisition(
    const std::filesystem::path& store, nlohmann::ordered_json& warnings);

}  // namespace palpate::apps
