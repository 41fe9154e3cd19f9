// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

namespace palpate::bench {

/// The normal force of a place as recorded, at several depths.
struct PressedPlace {
  Eigen::Vector2d at = Eigen::Vector2d::Zero();  ///< [mm]
  std::vector<double> depths, forces;            ///< [mm], [N]
};

/// Linear interpolation over the Delaunay triangles of the places of the force at equal depth, and
/// of that between depths; the nearest place outside of the triangles.
[[nodiscard]] double barycentric_force(std::span<const PressedPlace> places,
                                       const Eigen::Vector2d& at, double depth);

/// A Gaussian process on (x, y, depth) with a constant mean, a length scale along each axis, and
/// the better of a squared exponential and a Matern 5/2 covariance. All parameters maximise the
/// likelihood of up to 400 records.
struct ProcessSettings {
  Eigen::Vector3d lengths = Eigen::Vector3d::Ones();  ///< [mm]
  double amplitude = 1, noise = 1, mean = 0;          ///< [N]
  bool matern = false;
};
[[nodiscard]] ProcessSettings learn_process(std::span<const PressedPlace> places);

/// Predicts from all records of up to 150 places, the nearest ones.
[[nodiscard]] std::vector<double> process_forces(const ProcessSettings& settings,
                                                 std::span<const PressedPlace> places,
                                                 const PressedPlace& wanted);

}  // namespace palpate::bench
