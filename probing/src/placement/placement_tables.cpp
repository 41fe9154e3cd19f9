// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/probing/placement_tables.h"

#include <array>
#include <cmath>
#include <string_view>

#include "palpate/core/error.h"
#include "palpate/probing/csv.h"

namespace palpate::probing {
namespace {

constexpr std::array<std::string_view, 3> kTouch{"x", "y", "z"};
constexpr std::array<std::string_view, 8> kPose{"range_map", "x", "y", "z", "qx", "qy", "qz", "qw"};

}  // namespace

Eigen::Matrix3Xd read_touches(const std::filesystem::path& path) {
  CsvReader rows(path, kTouch);
  std::vector<Eigen::Vector3d> tips;
  while (rows.next()) tips.push_back(rows.vector(0));
  if (tips.empty()) throw FileError(path.string() + ": has no touches; give one in each line");
  Eigen::Matrix3Xd columns(3, static_cast<Eigen::Index>(tips.size()));
  for (std::size_t i = 0; i < tips.size(); ++i) columns.col(static_cast<Eigen::Index>(i)) = tips[i];
  return columns;
}

std::vector<SeenPose> read_seen_poses(const std::filesystem::path& path) {
  // A tip that does not turn has no such columns, which stands for the quaternion 0 in all rows.
  const TableLayout layout{.defaults = {{"qx", "0"}, {"qy", "0"}, {"qz", "0"}, {"qw", "0"}}};
  CsvReader rows(path, kPose, layout);
  std::vector<SeenPose> poses;
  while (rows.next()) {
    SeenPose& pose = poses.emplace_back(SeenPose{.seen = rows.text(0), .tip = rows.vector(1)});
    const std::string place = path.string() + ", line " + std::to_string(rows.line());
    if (pose.seen.empty())
      throw FileError(place + ": 'range_map' is empty; name the file with what the camera saw");
    const Eigen::Quaterniond turn(rows.number(7), rows.number(4), rows.number(5), rows.number(6));
    if (turn.norm() == 0) continue;
    constexpr double kUnit = 1e-3;  // accepts numbers rounded to four decimals
    if (!(std::abs(turn.norm() - 1) <= kUnit)) {
      throw FileError(place + ": the quaternion qx, qy, qz, qw has the length " +
                      to_text(turn.norm()) + "; its length must be 1");
    }
    pose.R_base_tip = turn;
  }
  if (poses.empty()) throw FileError(path.string() + ": has no poses; give one in each line");
  for (const SeenPose& pose : poses) {
    if (pose.R_base_tip.has_value() != poses.front().R_base_tip.has_value()) {
      throw FileError(path.string() +
                      ": only some lines have a quaternion qx, qy, qz, qw; give it in all or in "
                      "none");
    }
  }
  return poses;
}

}  // namespace palpate::probing
