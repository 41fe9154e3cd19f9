// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>

namespace palpate::bench {

/// Force [N] against displacement [mm] at one contact, however it was learnt.
struct Predictor {
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> force;
  std::size_t numbers = 0;  ///< that must be stored to evaluate it
};

/// What one would write at home: a regular grid of `nodes` to the power of three over the bounding
/// box of the displacements, at each node a local linear fit to the nearest samples, linear between
/// nodes; outside the box the force at its border. 3 x N displacements and forces.
[[nodiscard]] Predictor grid_lookup(const Eigen::Matrix3Xd& displacements,
                                    const Eigen::Matrix3Xd& forces, int nodes);

/// Exact interpolation of each component by a multiquadric at every sample and at zero, with a
/// linear polynomial. The rounding is the mean distance of nearest neighbours (Hardy's choice up to
/// a factor). Samples closer together than their noise make the system ill-conditioned, not the
/// force wrong at the samples.
[[nodiscard]] Predictor exact_rbf(const Eigen::Matrix3Xd& displacements,
                                  const Eigen::Matrix3Xd& forces);

/// A Gaussian process for each component, squared exponential kernel with one length scale, noise
/// as a share of the signal: both by the marginal likelihood, searched on a logarithmic grid. Zero
/// displacement with zero force is one sample more.
[[nodiscard]] Predictor gaussian_process(const Eigen::Matrix3Xd& displacements,
                                         const Eigen::Matrix3Xd& forces);

/// The least squares of isotropic multiquadrics alone with weights >= 0, as many as it takes, of a
/// dense dictionary: centres on a grid over three times the bounding box of displacements and zero,
/// some roundings each (Lawson and Hanson's active set, to its optimum). How near such bases can
/// get to the samples, whatever their number.
[[nodiscard]] Predictor isotropic_only(const Eigen::Matrix3Xd& displacements,
                                       const Eigen::Matrix3Xd& forces);

}  // namespace palpate::bench
