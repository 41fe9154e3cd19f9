// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/trajectory_file.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <nlohmann/json.hpp>
#include <ostream>
#include <string>
#include <system_error>

#include "palpate/core/error.h"
#include "palpate/core/output_file.h"
#include "palpate/haptics/trajectory_csv.h"

namespace palpate::haptics {
namespace {

constexpr const char* kTrajectoryFormat = "palpate trajectory";
constexpr int kTrajectoryVersion = 1;
static_assert(std::endian::native == std::endian::little, "the file is in the order of the host");

using PointNumbers = std::array<double, 4>;  // t, x, y, z

/// The head of a binary trajectory; discarded if the file is something else.
nlohmann::json trajectory_head(std::ifstream& file) {
  constexpr std::size_t kLongestHead = 4096;  // [bytes]
  std::string line;
  char letter = 0;
  while (line.size() < kLongestHead && file.get(letter) && letter != '\n') line += letter;
  return nlohmann::json::parse(line, nullptr, false);
}

std::vector<TrajectoryPoint> read_points(std::ifstream& file, std::uint64_t count,
                                         const std::string& name) {
  std::vector<TrajectoryPoint> points;
  PointNumbers numbers{};
  while (points.size() < count &&
         file.read(reinterpret_cast<char*>(numbers.data()), sizeof(numbers))) {
    const TrajectoryPoint point{numbers[0], Eigen::Vector3d(&numbers[1])};
    const std::string where = name + ": point " + std::to_string(points.size());
    if (!std::isfinite(point.time) || !point.tool.allFinite()) {
      throw FileError(where + " is not finite; times and positions must be numbers");
    }
    if (!points.empty() && !(point.time > points.back().time)) {
      throw FileError(where + " is not later than the one before; points must be in order of time");
    }
    points.push_back(point);
  }
  if (points.size() < count) {
    throw FileError(name + ": ends after " + std::to_string(points.size()) + " of " +
                    std::to_string(count) + " points; the file is truncated");
  }
  if (points.empty()) throw FileError(name + ": has no points; at least one is needed");
  return points;
}

}  // namespace

std::vector<TrajectoryPoint> read_trajectory_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || file.peek() != '{') return read_trajectory(path);
  const nlohmann::json head = trajectory_head(file);
  const auto format = head.find("format");
  if (!head.is_object() || format == head.end() || *format != kTrajectoryFormat) {
    throw FileError(path.string() + ": is neither a CSV file with the columns t,x,y,z nor a " +
                    kTrajectoryFormat);
  }
  const auto version = head.find("version");
  if (version == head.end() || *version != kTrajectoryVersion) {
    throw FileError(path.string() + ": is a trajectory of version " +
                    (version == head.end() ? "(none)" : version->dump()) +
                    "; this program reads version " + std::to_string(kTrajectoryVersion));
  }
  const auto points = head.find("points");
  if (points == head.end() || !points->is_number_unsigned()) {
    throw FileError(path.string() + ": the head does not say how many points there are");
  }
  return read_points(file, points->get<std::uint64_t>(), path.string());
}

void write_binary_trajectory(const std::filesystem::path& path,
                             std::span<const TrajectoryPoint> trajectory) {
  write_file(path, [&](std::ostream& out) {
    out << nlohmann::ordered_json{{"format", kTrajectoryFormat},
                                  {"version", kTrajectoryVersion},
                                  {"byte_order", "little"},
                                  {"points", trajectory.size()}}
               .dump()
        << '\n';
    for (const TrajectoryPoint& point : trajectory) {
      const PointNumbers numbers{point.time, point.tool.x(), point.tool.y(), point.tool.z()};
      out.write(reinterpret_cast<const char*>(numbers.data()), sizeof(numbers));
    }
  });
}

}  // namespace palpate::haptics
