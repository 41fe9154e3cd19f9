// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <opencv2/core.hpp>
#include <vector>

#include "palpate/geometry/triangle_mesh.h"
#include "palpate/haptics/friction_cone.h"
#include "palpate/haptics/playback.h"
#include "palpate/probing/acquisition.h"
#include "palpate/sensing/pattern.h"
#include "palpate/sensing/rig.h"
#include "palpate/sensing/rig_calibration.h"
#include "palpate/sensing/trained_colors.h"

namespace palpate::extremes {

/// The place of each element of the standard input in a reordered one: `to[i]` of element i.
struct Order {
  std::vector<int> sheet_vertices, sheet_triangles, ball_vertices, ball_triangles;
  std::vector<int> cloud, places, contacts, samples;
};

/// The input of all operations: small, of every kind, and easy to scale, move, turn and reorder.
///
/// Coordinates are multiples of a power of two, so that moving them by a power of two is exact.
/// Operations take their own lengths and forces, such as a tolerance, as multiples of `length` and
/// `force`, and turn and move their own directions and places by `place`.
struct Input {
  double length = 1;  ///< [mm] 1 in the standard input
  double force = 1;   ///< [N] 1 in the standard input
  int extent = 1;     ///< how many times as wide as the standard input, at the same density
  Eigen::Isometry3d place = Eigen::Isometry3d::Identity();

  geometry::TriangleMesh sheet;  ///< 84 mm x 60 mm in x and y, curved, open, with a hole
  geometry::TriangleMesh ball;   ///< closed, of about 20 mm about the origin, without symmetry
  Eigen::Matrix3Xd cloud;        ///< [mm] near `ball`, with noise of 0.1 mm
  Eigen::Matrix3Xd places;       ///< [mm] about both
  std::vector<geometry::SurfacePoint> contacts;  ///< on `sheet`

  Eigen::Matrix3Xd displacements;              ///< [mm] of one contact, in its frame, z inwards
  Eigen::Matrix3Xd forces;                     ///< [N] that go with them
  std::vector<haptics::FrictionTrial> trials;  ///< of one contact that is pressed along z
  probing::Acquisition acquisition;            ///< of contacts on `sheet`
  std::vector<haptics::TrajectoryPoint> trajectory;  ///< a tool that presses `sheet` and drags

  sensing::Rig rig;
  sensing::Pattern pattern;
  sensing::TrainedColors colors;
  cv::Mat frame;                        ///< the image of a ball in the camera of `rig`
  std::vector<sensing::RigView> views;  ///< of a board, in the rig of boards.h

  Order order;
};

/// Takes no threads, so that processes can be made afterwards.
[[nodiscard]] const Input& standard_input();

/// The same with fewer contacts and samples, for what is done hundreds of times.
[[nodiscard]] const Input& small_input();

/// Many times as wide, at the same density: with `extent`^2 times as many triangles, points,
/// contacts, samples, trials, ticks and pixels. Kept for the next call.
/// \param extent a power of two
[[nodiscard]] const Input& wide_input(int extent);

/// The same object in another unit: all lengths and forces times powers of two.
[[nodiscard]] Input scaled(Input input, double length, double force);

/// The same object at another place. Displacements, forces and trials of one contact, which are in
/// its frame, and what a camera sees stay as they are.
[[nodiscard]] Input moved(Input input, const Eigen::Isometry3d& motion);

/// The same object with its vertices, triangles, points, contacts and samples in another order.
[[nodiscard]] Input reordered(Input input, unsigned seed);

}  // namespace palpate::extremes
