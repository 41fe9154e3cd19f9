// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>

#include "palpate/probing/acquisition.h"

namespace palpate::probing {

/// How the files of another program differ.
struct AcquisitionCsvOptions {
  std::optional<char> separator = std::nullopt;  ///< as in `CsvLayout`
  /// As in `CsvLayout`, for both files. "contacts.id" and "samples.id" are the column `id` of one
  /// of them.
  std::map<std::string, std::string, std::less<>> names = {};
  double length = 1;            ///< [mm] unit of positions; > 0 and finite
  double force = 1;             ///< [N] unit of forces; > 0 and finite
  bool forces_on_tool = false;  ///< forces are those of the object on the tool: the signs change
};

/// [N] Force of a unit given by name: N, mN, kN, g (the weight of a gram), kg or lbf.
/// \throws InvalidInput for another name, with the names that are known.
[[nodiscard]] double unit_force(std::string_view name);

/// Reads an acquisition from two CSV files (see csv.h) with the columns
/// `id,x,y,z,nx,ny,nz` and
/// `id,contact,group_id,px,py,pz,ax,ay,az,bx,by,bz,on_friction_boundary,slipped,range_map,time`;
/// flags are 0 or 1, and range_map may be empty. docs/measurements.md describes the columns.
///
/// \throws FileError naming the file, line, column, the text found and what would be right, also
/// for what `CheckedAcquisition` refuses.
/// \throws InvalidInput if an option is outside its range, or gives a name to no column.
[[nodiscard]] CheckedAcquisition read_acquisition_csv(const std::filesystem::path& contacts,
                                                      const std::filesystem::path& samples,
                                                      const AcquisitionCsvOptions& options = {});

/// Writes the two files, numbers in the shortest form that reads back exactly. They do not hold
/// `meta`.
///
/// \throws InvalidInput if the name of a range map holds a line break, before anything is written.
/// \throws OutputError if a file cannot be written.
void write_acquisition_csv(const CheckedAcquisition& acquisition,
                           const std::filesystem::path& contacts,
                           const std::filesystem::path& samples);

}  // namespace palpate::probing
