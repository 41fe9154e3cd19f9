// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/trajectory_csv.h"

#include <array>
#include <ostream>
#include <string_view>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/probing/csv.h"

namespace palpate::haptics {
namespace {

constexpr std::array<std::string_view, 4> kTrajectoryColumns = {"t", "x", "y", "z"};
constexpr std::array<std::string_view, 11> kTraceColumns = {"t",  "x",  "y",  "z",  "cx",   "cy",
                                                            "cz", "fx", "fy", "fz", "state"};

}  // namespace

std::vector<TrajectoryPoint> read_trajectory(const std::filesystem::path& path) {
  probing::CsvReader row(path, kTrajectoryColumns);
  std::vector<TrajectoryPoint> trajectory;
  while (row.next()) {
    const TrajectoryPoint point{row.number(0), row.vector(1)};
    if (!trajectory.empty() && !(point.time > trajectory.back().time)) {
      throw FileError(path.string() + ": line " + std::to_string(row.line()) +
                      ", column 't': the time is not later than in the line before; lines must be "
                      "in order of time");
    }
    trajectory.push_back(point);
  }
  if (trajectory.empty()) {
    throw FileError(path.string() +
                    ": there is no line of numbers below the column names; at least one is needed");
  }
  return trajectory;
}

void write_trace(const std::filesystem::path& path, std::span<const TracePoint> trace) {
  write_file(path, [&](std::ostream& out) {
    probing::write_csv_header(out, kTraceColumns);
    for (const TracePoint& point : trace) {
      out << probing::to_text(point.time);
      for (const Eigen::Vector3d& v : {point.tool, point.contact, point.force}) {
        for (const double value : v) out << ',' << probing::to_text(value);
      }
      out << ',' << to_string(point.state) << '\n';
    }
  });
}

}  // namespace palpate::haptics
