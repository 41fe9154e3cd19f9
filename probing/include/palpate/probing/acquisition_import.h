// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <filesystem>
#include <limits>
#include <span>

#include "palpate/probing/acquisition.h"
#include "palpate/probing/acquisition_mapping.h"

namespace palpate::probing {

/// Counts of the presses found in recordings and of those left out, over all files.
struct SeriesCounts {
  std::size_t presses = 0;        ///< with those that are empty
  std::size_t empty_presses = 0;  ///< presses without a quasi-static piece
  std::size_t saturated = 0, unpaired = 0, fast = 0, brief = 0;  ///< as in `SeriesPresses`
  std::size_t slides = 0;              ///< presses in which the tip slid along the surface
  std::size_t drags = 0;               ///< samples with a drag, without those that slipped
  std::size_t drags_without_base = 0;  ///< drags left out: no press had their normal force
  std::size_t not_extrapolated = 0;    ///< touches left where the force passed `touch_force`
  /// [mm] Medians over the other touches: how far they were moved back to zero force, and the
  /// standard deviation of that. NaN if there is none.
  double touch_depth = std::numeric_limits<double>::quiet_NaN();
  double touch_deviation = std::numeric_limits<double>::quiet_NaN();
};

struct ImportedAcquisition {
  CheckedAcquisition acquisition;
  SeriesCounts series = {};  ///< zeros without a time series
};

/// Reads contacts and samples from files with the extension .mat (see mat_file.h) and CSV files
/// (all others, see csv.h).
///
/// With `ContactSource::table`, `files` are the two tables, or one MAT file that holds both.
/// Otherwise they are any number of files with the same columns; `row_number` goes on from file to
/// file, and a column named `file_number` is the number of the file, from 1.
/// \throws FileError naming the file, row, column, the text found and what would be right, also
/// for what `CheckedAcquisition` refuses. MissingColumn if a file lacks a column.
/// \throws InvalidInput if the mapping is not valid, or does not suit the number of files.
[[nodiscard]] ImportedAcquisition import_acquisition(std::span<const std::filesystem::path> files,
                                                     const AcquisitionMapping& mapping = {});

}  // namespace palpate::probing
