// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <exception>
#include <limits>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/probing/contact_equilibrium.h"
#include "solid_meshes.h"

// Random ways of a tip on solids, far beyond what a campaign orders: each must converge, or end by
// a named stop.
namespace palpate::support {

struct PathSolid {
  std::string name;
  probing::DeformableBody body;
  double width = 0, length = 0;  ///< [mm] of the rectangle about the origin that is touched
  double depth = 0;              ///< [mm] that the tip goes at most
  double aside = 0;              ///< [mm] that it goes across at most
  double force = 0;              ///< [N] that presses at most
};

/// A block of 40 x 40 x 16 mm on a table, pressed by up to half its thickness.
inline PathSolid path_block(double bulk_ratio, int cells, int layers) {
  PathSolid solid;
  solid.name = "block, bulk modulus " + std::to_string(static_cast<int>(bulk_ratio)) +
               " times shear modulus";
  solid.body.mesh =
      probing::box_mesh(evenly(-20, 20, cells), evenly(-20, 20, cells), evenly(0, 16, layers));
  solid.body.materials = {{.shear_modulus = 0.05, .bulk_modulus = 0.05 * bulk_ratio}};
  support_where(solid.body, [](const Eigen::Vector3d& at) { return at.z() == 16; });
  solid.width = solid.length = 15;
  solid.depth = 8;
  solid.aside = 4;
  solid.force = 10;
  return solid;
}

/// A sheet of 100 x 60 x 2 mm, stretched by a tenth between its ends, and pushed out by up to 24
/// mm.
inline PathSolid path_sheet(int cells, int cells_across) {
  PathSolid solid;
  solid.name = "stretched sheet";
  solid.body.mesh =
      probing::box_mesh(evenly(-50, 50, cells), evenly(-30, 30, cells_across), {0, 2});
  solid.body.materials = {{.shear_modulus = 0.2, .bulk_modulus = 4}};
  support_where(solid.body, [](const Eigen::Vector3d& at) { return std::abs(at.x()) == 50; });
  move_supports(solid.body, [](const Eigen::Vector3d& at) {
    return Eigen::Vector3d(std::copysign(5, at.x()), 0, 0);
  });
  solid.width = 40;
  solid.length = 22;
  solid.depth = 24;
  solid.aside = 8;
  solid.force = 8;
  return solid;
}

struct PathCounts {
  int paths = 0;                       ///< all that were begun
  int converged = 0;                   ///< to their last point
  int points = 0;                      ///< equilibria that were found
  double deepest = 0;                  ///< [mm] of these
  std::map<std::string, int> stops;    ///< paths that ended early, by the name of the stop
  std::map<std::string, int> refused;  ///< paths that ended by an error of Palpate, by its text
  std::vector<std::string> broken;     ///< events that must never happen
};

namespace random_path {

/// The same on each platform, unlike the distributions of the standard library.
inline double uniform(std::mt19937& random, double low, double high) {
  return low + (high - low) * (static_cast<double>(random()) / 4294967296.0);
}

inline Eigen::Vector3d across(std::mt19937& random, double largest) {
  const double angle = uniform(random, 0, 2 * std::numbers::pi), size = uniform(random, 0, largest);
  return {size * std::cos(angle), size * std::sin(angle), 0};
}

/// Returns true if the tip, a ball of 5 mm, touches a face that a support holds at one of its
/// nodes. The support then takes a part of the tip's force that its node forces do not show.
inline bool touches_support(const probing::ContactEquilibrium& solid,
                            const probing::ContactState& state) {
  constexpr double kReach = 5.1;  // [mm] the radius, and what the grid below passes over
  constexpr int kGrid = 12;       // parts of an edge
  const std::vector<int>& held = solid.body().supported;
  for (const probing::BoundaryFace& face : solid.faces()) {
    const bool supported = std::ranges::any_of(
        face.nodes, [&](int node) { return std::ranges::find(held, node) != held.end(); });
    if (!supported) continue;
    for (int i = 0; i <= kGrid; ++i) {
      for (int j = 0; i + j <= kGrid; ++j) {
        const double b = static_cast<double>(i) / kGrid, c = static_cast<double>(j) / kGrid;
        const double a = 1 - b - c;
        Eigen::Vector<double, 6> shape;
        shape << a * (2 * a - 1), b * (2 * b - 1), c * (2 * c - 1), 4 * a * b, 4 * b * c, 4 * c * a;
        if ((state.positions(Eigen::all, face.nodes) * shape - state.tip).norm() < kReach)
          return true;
      }
    }
  }
  return false;
}

/// The error of a result; empty if there is none.
inline std::string flaw(const probing::ContactEquilibrium& solid,
                        const probing::ContactResult& result, bool by_force,
                        const Eigen::Vector3d& target) {
  constexpr double kBalance = 1e-4;  // of the force, between tip and supports
  const probing::ContactState& state = result.state;
  if (!state.positions.allFinite() || !state.tip.allFinite() || !state.force.allFinite())
    return "not a number";
  if (result.stop != probing::ContactStop::converged) return "";
  const double scale = std::max(1e-3, state.force.norm());
  if (by_force && (state.force - target).norm() > kBalance * scale) return "not the force";
  if (!by_force && state.tip != target) return "not the place";
  if (touches_support(solid, state)) return "";
  const Eigen::Matrix3Xd forces = node_forces(solid.body(), state.positions);
  const Eigen::Matrix3Xd at_rest = node_forces(solid.body(), solid.rest());
  Eigen::Vector3d held = Eigen::Vector3d::Zero();
  double size = scale;
  for (const int node : solid.body().supported) {
    held += forces.col(node);
    size += at_rest.col(node).norm();
  }
  if ((held + state.force).norm() > kBalance * size) return "supports do not balance the tip";
  return "";
}

}  // namespace random_path

/// Adds path `seed` on a solid with a tip of 5 mm. Every second path is one of forces, the others
/// are of places.
inline void follow_random_path(const PathSolid& object, const probing::ContactEquilibrium& solid,
                               unsigned seed, int points, PathCounts& counts) {
  using namespace random_path;
  using Eigen::Vector3d;
  std::mt19937 random(seed);
  const bool by_force = seed % 2 == 0;
  const std::string name = object.name + ", path " + std::to_string(seed);
  ++counts.paths;
  try {
    const Vector3d place(uniform(random, -object.width, object.width),
                         uniform(random, -object.length, object.length), 0);
    constexpr double kSlope = 0.5;  // tangent of the largest angle of the tip's way to the normal
    const Vector3d inward = (Vector3d::UnitZ() + across(random, kSlope)).normalized();
    const probing::ContactState start = solid.touch(place, inward);
    probing::ContactState state = start;
    for (int i = 0; i < points; ++i) {
      Vector3d target;
      if (by_force) {
        // Small forces are as frequent as large ones; across up to 1.2 times as much.
        const double normal = object.force * std::pow(10, uniform(random, -2, 0));
        target = Vector3d(0, 0, normal) + across(random, 1.2 * normal);
      } else {
        target = start.tip + uniform(random, 0.01, 1) * object.depth * Vector3d::UnitZ() +
                 across(random, object.aside);
      }
      const probing::ContactResult result =
          by_force ? solid.apply_force(state, target) : solid.move_tip(state, target);
      if (const std::string wrong = flaw(solid, result, by_force, target); !wrong.empty())
        counts.broken.push_back(name + ": " + wrong);
      if (result.stop != probing::ContactStop::converged) {
        ++counts.stops[to_string(result.stop)];
        return;
      }
      state = result.state;
      ++counts.points;
      counts.deepest = std::max(counts.deepest, state.tip.z() - start.tip.z());
    }
    ++counts.converged;
  } catch (const Error& e) {
    ++counts.refused[e.what()];
  } catch (const std::exception& e) {
    counts.broken.push_back(name + ": " + e.what());
  }
}

}  // namespace palpate::support
