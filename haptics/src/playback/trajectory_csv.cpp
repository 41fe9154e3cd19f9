// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/trajectory_csv.h"

#include <array>
#include <ostream>
#include <string_view>

#include "palpate/error.h"
#include "palpate/output_file.h"
#include "palpate/probing/csv.h"

namespace palpate::haptics {
namespace {

using probing::CsvReader;

constexpr std::array<std::string_view, 4> kTrajectoryColumns = {"t", "x", "y", "z"};
constexpr std::array<std::string_view, 9> kQueryColumns = {"cx", "cy", "cz", "dx", "dy",
                                                           "dz", "fx", "fy", "fz"};
constexpr std::array<std::string_view, 11> kTraceColumns = {"t",  "x",  "y",  "z",  "cx",   "cy",
                                                            "cz", "fx", "fy", "fz", "state"};

Eigen::Vector3d vector(const CsvReader& row, std::size_t column) {
  return {row.number(column), row.number(column + 1), row.number(column + 2)};
}

template <typename T>
void check_rows(const std::vector<T>& rows, const std::filesystem::path& path) {
  if (!rows.empty()) return;
  throw FileError(path.string() +
                  ": there is no line of numbers below the column names; at least one is needed");
}

}  // namespace

const char* to_string(ContactState state) {
  switch (state) {
    case ContactState::free:
      return "free";
    case ContactState::stick:
      return "stick";
    case ContactState::slip:
      return "slip";
  }
  return "unknown";
}

std::vector<TrajectoryPoint> read_trajectory(const std::filesystem::path& path) {
  CsvReader row(path, kTrajectoryColumns);
  std::vector<TrajectoryPoint> trajectory;
  while (row.next()) {
    const TrajectoryPoint point{row.number(0), vector(row, 1)};
    if (!trajectory.empty() && !(point.time > trajectory.back().time)) {
      throw FileError(path.string() + ": line " + std::to_string(row.line()) +
                      ", column 't': the time is not later than in the line before; lines must be "
                      "in order of time");
    }
    trajectory.push_back(point);
  }
  check_rows(trajectory, path);
  return trajectory;
}

std::vector<Query> read_queries(const std::filesystem::path& path) {
  CsvReader row(path, kQueryColumns);
  std::vector<Query> queries;
  while (row.next()) queries.push_back({vector(row, 0), vector(row, 3), vector(row, 6)});
  check_rows(queries, path);
  return queries;
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
