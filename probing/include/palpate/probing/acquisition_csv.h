// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/probing/acquisition.h"

namespace palpate::probing {

/// Reads an acquisition from two CSV files (see csv.h) with the columns
/// `id,x,y,z,nx,ny,nz` and
/// `id,contact,group_id,px,py,pz,ax,ay,az,bx,by,bz,on_friction_boundary,slipped,range_map,time`;
/// flags are 0 or 1, and range_map may be empty. docs/measurements.md describes the columns.
/// `import_acquisition` reads files with other columns.
///
/// \throws FileError naming the file, line, column, the text found and what would be right, also
/// for what `CheckedAcquisition` refuses.
[[nodiscard]] CheckedAcquisition read_acquisition_csv(const std::filesystem::path& contacts,
                                                      const std::filesystem::path& samples);

/// Writes the two files, numbers in the shortest form that reads back exactly. They do not hold
/// `meta`.
///
/// \throws InvalidInput if the name of a range map holds a line break, before anything is written.
/// \throws OutputError if a file cannot be written.
void write_acquisition_csv(const CheckedAcquisition& acquisition,
                           const std::filesystem::path& contacts,
                           const std::filesystem::path& samples);

}  // namespace palpate::probing
