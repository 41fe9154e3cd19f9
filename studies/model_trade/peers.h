// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>

namespace palpate::bench {

/// Force [N] as a function of displacement [mm] at one contact, learnt by any method.
struct Predictor {
  std::function<Eigen::Vector3d(const Eigen::Vector3d&)> force;
  std::size_t numbers = 0;  ///< that must be stored for evaluation
};

/// A simple baseline: a regular grid of `nodes` to the power of three over the bounding box of the
/// displacements, with a local linear fit to the nearest samples at each node and linear
/// interpolation between nodes; outside the box the force at its border. 3 x N displacements and
/// forces.
[[nodiscard]] Predictor grid_lookup(const Eigen::Matrix3Xd& displacements,
                                    const Eigen::Matrix3Xd& forces, int nodes);

/// Exact interpolation of each component by a multiquadric at every sample and at zero, with a
/// linear polynomial. The rounding is the mean distance of nearest neighbours (Hardy's choice up to
/// a factor). Samples closer together than their noise make the system ill-conditioned, not the
/// force wrong at the samples.
[[nodiscard]] Predictor exact_rbf(const Eigen::Matrix3Xd& displacements,
                                  const Eigen::Matrix3Xd& forces);

/// A Gaussian process for each component with a squared exponential kernel with one length scale
/// and noise as a share of the signal, both chosen by the marginal likelihood on a logarithmic
/// grid. Zero force at zero displacement is one additional sample.
[[nodiscard]] Predictor gaussian_process(const Eigen::Matrix3Xd& displacements,
                                         const Eigen::Matrix3Xd& forces);

/// Least squares with isotropic multiquadrics alone, with weights >= 0 and any number of bases from
/// a dense dictionary: centres on a grid over three times the bounding box of displacements and
/// zero, with some roundings each (Lawson and Hanson's active set method, run to its optimum).
/// Shows how closely such bases can approximate the samples.
[[nodiscard]] Predictor isotropic_only(const Eigen::Matrix3Xd& displacements,
                                       const Eigen::Matrix3Xd& forces);

}  // namespace palpate::bench
