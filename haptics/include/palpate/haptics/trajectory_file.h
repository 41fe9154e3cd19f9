// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "palpate/haptics/playback.h"

namespace palpate::haptics {

/// Reads a trajectory: a CSV file (see `read_trajectory`) or a binary one. A binary file begins
/// with one line of JSON, {"format": "palpate trajectory", "version": 1, "byte_order": "little",
/// "points": N}, and a line break; then t, x, y, z of each point [s, mm] as doubles of 8 bytes.
/// \throws FileError naming the line or the point, what is wrong and what would be right.
[[nodiscard]] std::vector<TrajectoryPoint> read_trajectory_file(const std::filesystem::path& path);

/// Writes such a binary file. The numbers read back exactly.
/// \throws OutputError if the file cannot be written.
void write_binary_trajectory(const std::filesystem::path& path,
                             std::span<const TrajectoryPoint> trajectory);

}  // namespace palpate::haptics
