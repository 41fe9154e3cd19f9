// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/probing/acquisition.h"

namespace palpate::probing {

/// Reads an SQLite database with the tables `contact(id, x, y, z, nx, ny, nz)`,
/// `sample(id, contact, group_id, px, ..., bz, on_friction_boundary, slipped, range_map, time)` and
/// `meta(key, value)`. Records come in the order of their ids. Further tables and columns are
/// ignored.
/// \throws FileError if it is missing, empty, truncated, not such a database, or holds what
/// `check_acquisition` refuses.
[[nodiscard]] Acquisition read_acquisition(const std::filesystem::path& path);

/// Writes such a database beside `path` and renames it.
/// \throws InvalidInput if `check_acquisition` refuses, before anything is written; OutputError.
void write_acquisition(const std::filesystem::path& path, const Acquisition& acquisition);

}  // namespace palpate::probing
