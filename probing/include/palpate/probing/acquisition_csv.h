// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>

#include "palpate/probing/acquisition.h"

namespace palpate::probing {

/// Reads an acquisition from two CSV files (see csv.h) with the columns
/// `id,x,y,z,nx,ny,nz` and
/// `id,contact,group_id,px,py,pz,ax,ay,az,bx,by,bz,on_friction_boundary,slipped,range_map,time`;
/// flags are 0 or 1, range_map may be empty.
/// \throws FileError naming file, line, column, the text found and what would be right, also for
/// what `check_acquisition` refuses.
[[nodiscard]] Acquisition read_acquisition_csv(const std::filesystem::path& contacts,
                                               const std::filesystem::path& samples);

/// Writes the two files; numbers in their shortest form that reads back exactly. `meta` has no
/// place in them.
/// \throws InvalidInput if `check_acquisition` refuses, before anything is written; OutputError.
void write_acquisition_csv(const Acquisition& acquisition, const std::filesystem::path& contacts,
                           const std::filesystem::path& samples);

}  // namespace palpate::probing
