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

using probing::CsvTable;

constexpr std::array<std::string_view, 4> kTrajectoryColumns = {"t", "x", "y", "z"};
constexpr std::array<std::string_view, 9> kQueryColumns = {"cx", "cy", "cz", "dx", "dy",
                                                           "dz", "fx", "fy", "fz"};
constexpr std::array<std::string_view, 11> kTraceColumns = {"t",  "x",  "y",  "z",  "cx",   "cy",
                                                            "cz", "fx", "fy", "fz", "state"};

Eigen::Vector3d vector(const CsvTable& table, std::size_t row, std::size_t column) {
  return {table.number(row, column), table.number(row, column + 1), table.number(row, column + 2)};
}

void check_rows(const CsvTable& table, const std::filesystem::path& path) {
  if (table.rows() > 0) return;
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
  const CsvTable table(path, kTrajectoryColumns);
  check_rows(table, path);
  std::vector<TrajectoryPoint> trajectory(table.rows());
  for (std::size_t row = 0; row < table.rows(); ++row) {
    trajectory[row] = {table.number(row, 0), vector(table, row, 1)};
    if (row > 0 && !(trajectory[row].time > trajectory[row - 1].time)) {
      throw FileError(path.string() + ": line " + std::to_string(table.line(row)) +
                      ", column 't': the time is not later than in the line before; lines must be "
                      "in order of time");
    }
  }
  return trajectory;
}

std::vector<Query> read_queries(const std::filesystem::path& path) {
  const CsvTable table(path, kQueryColumns);
  check_rows(table, path);
  std::vector<Query> queries(table.rows());
  for (std::size_t row = 0; row < table.rows(); ++row) {
    queries[row] = {vector(table, row, 0), vector(table, row, 3), vector(table, row, 6)};
  }
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
