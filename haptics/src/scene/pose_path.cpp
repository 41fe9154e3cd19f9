// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include "palpate/haptics/pose_path.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>

#include "palpate/core/error.h"
#include "palpate/haptics/rotation.h"
#include "palpate/probing/csv.h"

namespace palpate::haptics {
namespace {

constexpr double kPoseRotation = 1e-6;  // of the entries of R^T R, and of a quaternion's length
constexpr std::array<std::string_view, 8> kPoseColumns = {"t",  "x",  "y",  "z",
                                                          "qw", "qx", "qy", "qz"};

}  // namespace

PosePath::PosePath(std::vector<PosePoint> points) : points_(std::move(points)) {
  if (points_.empty()) throw InvalidInput("PosePath: there is no pose; at least one is needed");
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const PosePoint& point = points_[i];
    const std::string name = "PosePath: pose " + std::to_string(i);
    if (!std::isfinite(point.time)) throw InvalidInput(name + ": its time is not finite");
    if (i > 0 && !(point.time > points_[i - 1].time)) {
      throw InvalidInput(name +
                         " is not later than the one before; poses must be in order of time");
    }
    if (!point.T_world_object.translation().allFinite() ||
        !is_rotation(point.T_world_object.linear(), kPoseRotation)) {
      throw InvalidInput(name +
                         " is no rigid motion; it must be a rotation (orthogonal to 1e-6, "
                         "right-handed) and a translation in mm");
    }
  }
}

Eigen::Isometry3d PosePath::pose(double time) const noexcept {
  if (!(time > begin())) return points_.front().T_world_object;
  if (time >= end()) return points_.back().T_world_object;
  const auto next = std::ranges::upper_bound(points_, time, {}, &PosePoint::time);
  const PosePoint& before = *(next - 1);
  const double part = (time - before.time) / (next->time - before.time);
  const Eigen::Isometry3d &from = before.T_world_object, &to = next->T_world_object;
  const Eigen::Vector3d turn = rotation_log(from.linear().transpose() * to.linear());
  Eigen::Isometry3d pose = from;
  pose.linear() = from.linear() * rotation_exp(part * turn);
  pose.translation() += part * (to.translation() - from.translation());
  return pose;
}

PosePath read_pose_path(const std::filesystem::path& path) {
  probing::CsvReader row(path, kPoseColumns);
  std::vector<PosePoint> points;
  while (row.next()) {
    const std::string line = path.string() + ": line " + std::to_string(row.line());
    PosePoint point{.time = row.number(0)};
    if (!points.empty() && !(point.time > points.back().time)) {
      throw FileError(line +
                      ", column 't': the time is not later than in the line before; lines must be "
                      "in order of time");
    }
    const Eigen::Quaterniond rotation(row.number(4), row.number(5), row.number(6), row.number(7));
    if (!(std::abs(rotation.norm() - 1) <= kPoseRotation)) {
      throw FileError(line + ": the quaternion qw,qx,qy,qz has the length " +
                      probing::to_text(rotation.norm()) + "; it must be 1, to 1e-6");
    }
    point.T_world_object.linear() = rotation.normalized().toRotationMatrix();
    point.T_world_object.translation() = row.vector(1);
    points.push_back(point);
  }
  if (points.empty()) {
    throw FileError(path.string() +
                    ": there is no line of numbers below the column names; at least one is needed");
  }
  return PosePath(std::move(points));
}

}  // namespace palpate::haptics
