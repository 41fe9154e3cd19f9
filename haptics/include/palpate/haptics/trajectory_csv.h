// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <vector>

namespace palpate::haptics {

enum class ContactState { free, stick, slip };

/// "free", "stick" or "slip".
[[nodiscard]] const char* to_string(ContactState state);

/// Where the tool is at a time.
struct TrajectoryPoint {
  double time = 0;                                 ///< [s]
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();  ///< [mm] world
};

/// What the haptic loop answered.
struct TracePoint {
  double time = 0;                                 ///< [s]
  Eigen::Vector3d tool = Eigen::Vector3d::Zero();  ///< [mm] world
  Eigen::Vector3d contact =
      Eigen::Vector3d::Zero();  ///< [mm] on the undeformed surface; free: the tool
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] on the USER: minus that on the object
  ContactState state = ContactState::free;
};

/// What a force field should say at a place of the surface.
struct Query {
  Eigen::Vector3d contact = Eigen::Vector3d::Zero();       ///< [mm] on the undeformed surface
  Eigen::Vector3d displacement = Eigen::Vector3d::Zero();  ///< [mm] tool minus contact
  Eigen::Vector3d force = Eigen::Vector3d::Zero();         ///< [N] of the tool ON THE OBJECT
};

/// Reads a CSV file (see probing/csv.h) with the columns `t,x,y,z`, times ascending.
/// \throws FileError naming line and column; also if there is no row.
[[nodiscard]] std::vector<TrajectoryPoint> read_trajectory(const std::filesystem::path& path);

/// Reads a CSV file with the columns `cx,cy,cz,dx,dy,dz,fx,fy,fz`.
/// \throws FileError as above.
[[nodiscard]] std::vector<Query> read_queries(const std::filesystem::path& path);

/// Writes a CSV file with the columns `t,x,y,z,cx,cy,cz,fx,fy,fz,state`; `fx,fy,fz` is the force on
/// the user. Numbers read back exactly.
/// \throws OutputError.
void write_trace(const std::filesystem::path& path, std::span<const TracePoint> trace);

}  // namespace palpate::haptics
