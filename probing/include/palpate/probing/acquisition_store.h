// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/probing/acquisition.h"

namespace palpate::probing {

/// Reads an SQLite database with the tables `contact(id, x, y, z, nx, ny, nz)`,
/// `sample(id, contact, group_id, px, ..., bz, on_friction_boundary, slipped, range_map, time)` and
/// `meta(key, value)`, where `probe_radius` is that of `Acquisition`. Contacts come in the order of
/// their ids, and so do the samples of a contact. Further tables and columns are ignored.
///
/// \throws FileError if the file is missing, empty, truncated or not such a database, or if it
/// holds what `CheckedAcquisition` refuses.
[[nodiscard]] CheckedAcquisition read_acquisition(const std::filesystem::path& path);

/// Writes such a database beside `path`, then renames it.
///
/// \throws OutputError if it cannot be written.
void write_acquisition(const std::filesystem::path& path, const CheckedAcquisition& acquisition);

}  // namespace palpate::probing
