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

/// Checks that `write_acquisition` destroys nothing at `path`: that there is no file, an empty one,
/// or a database that it wrote. For callers that compute for long before they write.
///
/// \throws InvalidInput for any other file, such as the store of a campaign.
void check_acquisition_output(const std::filesystem::path& path);

/// Writes such a database beside `path`, then renames it.
///
/// \throws InvalidInput as `check_acquisition_output` does.
/// \throws OutputError if it cannot be written.
void write_acquisition(const std::filesystem::path& path, const CheckedAcquisition& acquisition);

}  // namespace palpate::probing
