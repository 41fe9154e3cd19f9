// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <random>
#include <string>
#include <utility>
#include <vector>

#include "palpate/geometry/surface_query.h"
#include "palpate/haptics/model.h"

namespace palpate::bench {

/// An object to play, with what says where its surface is.
class TouchedObject {
 public:
  TouchedObject(std::string name, haptics::Model model);

  std::string name;
  haptics::Model model;
  geometry::SurfaceQuery query;

  [[nodiscard]] Eigen::Vector3d normal(int triangle) const { return normals_.col(triangle); }
  /// [mm] from a place to the border; infinite without one.
  [[nodiscard]] double to_border(const Eigen::Vector3d& place) const;
  /// A vertex at random.
  [[nodiscard]] Eigen::Vector3d some_vertex(std::mt19937& random) const;

 private:
  Eigen::Matrix3Xd normals_;
  std::vector<std::pair<Eigen::Vector3d, Eigen::Vector3d>> border_;
};

// With the same friction at all contacts. Names: "hills", "sheet", "sheet with block", "ball",
// "hand".

/// All objects of the tables.
[[nodiscard]] std::vector<TouchedObject> touched_objects(double friction);
/// A height field of 200 x 200 mm with slopes of up to 0.6 and 100 contacts that differ.
[[nodiscard]] TouchedObject hills(double friction);
/// A height field of 60 x 60 mm with gentle waves and 49 contacts that differ.
[[nodiscard]] TouchedObject waves(double friction);
/// The sheet of demo/, or the one with a block, fitted.
[[nodiscard]] TouchedObject sheet(bool block, double friction);
/// A hand as a depth camera saw it.
[[nodiscard]] TouchedObject hand(double friction);

/// A tool that follows the surface in random directions, at 1 kHz and at most 150 mm/s.
/// \param depth [mm] below the surface at a time [s].
[[nodiscard]] std::vector<Eigen::Vector3d> wander(const TouchedObject& object, int ticks,
                                                  unsigned seed, double (*depth)(double time));

}  // namespace palpate::bench
