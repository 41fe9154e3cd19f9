// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <span>
#include <vector>

#include "palpate/haptics/playback.h"

namespace palpate::haptics {

/// Reads a CSV file (see probing/csv.h) with the columns `t,x,y,z`, in the order of time.
///
/// \throws FileError naming the line and column, or if there is no row.
[[nodiscard]] std::vector<TrajectoryPoint> read_trajectory(const std::filesystem::path& path);

/// Writes a CSV file with the columns `t,x,y,z,cx,cy,cz,fx,fy,fz,state`, where `fx,fy,fz` is the
/// force on the user. The numbers read back exactly.
///
/// \throws OutputError if the file cannot be written.
void write_trace(const std::filesystem::path& path, std::span<const TracePoint> trace);

}  // namespace palpate::haptics
