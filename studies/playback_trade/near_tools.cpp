// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "palpate/core/error.h"
#include "palpate/probing/closed_form.h"
#include "solids.h"
#include "tables.h"

namespace palpate::bench {
namespace {

using Eigen::Vector3d;

constexpr double kBall = 5;                                            // [mm] radius of the tools
constexpr std::array<double, 6> kDistances{10.1, 15, 20, 25, 30, 40};  // [mm]

// Prints a row of the table; `error` gives the part of the force for a distance [mm].
void print_row(const std::string& name, double depth,
               const std::function<double(double distance)>& error) {
  std::printf("| %s | %.1f |", name.c_str(), depth);
  for (const double distance : kDistances) {
    std::printf(" %.1f |", 100 * error(distance));
    std::fflush(stdout);
  }
  std::printf("\n");
}

// Both tools press on a solid at (-distance / 2, 0, 0) and (distance / 2, 0, 0), along x or y.
void compare_on_solid(const TradeSolid& solid, const Vector3d& along, double depth) {
  print_row(solid.name + (along.x() > 0 ? "" : ", side by side"), depth, [&](double distance) {
    const Vector3d place = -distance / 2 * along, other = distance / 2 * along;
    const auto alone = press(solid, place, {.radius = kBall, .depth = depth});
    const auto both = press(solid, place, {.radius = kBall, .depth = depth, .other = other});
    return alone && both ? *alone / *both - 1 : std::nan("");
  });
}

// Forces on tools that press on one strip of the closed-form sheet, each at its place x [mm] with
// its displacement: the energy of `Sheet`, with a corner of the strip below each tool.
class Strip {
 public:
  Strip(const probing::Sheet& sheet, std::vector<double> places)
      : sheet_(sheet), places_(std::move(places)) {}

  // [N] 3 x tools, at displacements 3 x tools [mm].
  [[nodiscard]] Eigen::Matrix3Xd forces(const Eigen::Matrix3Xd& displacements) const {
    // The corners e minimise the strip's energy and that of the springs to the tools.
    constexpr double kResidual = 1e-10, kDifference = 1e-5;  // [N], [mm]
    constexpr int kIterations = 200;
    Eigen::VectorXd e = displacements.reshaped() / 2;
    const auto unbalanced = [&](const Eigen::VectorXd& at) -> Eigen::VectorXd {
      return gradient(at) + (at - displacements.reshaped()) / sheet_.compliance;
    };
    for (int i = 0; i < kIterations; ++i) {
      const Eigen::VectorXd residual = unbalanced(e);
      if (residual.norm() < kResidual) {
        return ((displacements.reshaped() - e) / sheet_.compliance)
            .reshaped(3, displacements.cols());
      }
      Eigen::MatrixXd hessian(e.size(), e.size());
      for (Eigen::Index k = 0; k < e.size(); ++k) {
        const Eigen::VectorXd step = kDifference * Eigen::VectorXd::Unit(e.size(), k);
        hessian.col(k) = (unbalanced(e + step) - unbalanced(e - step)) / (2 * kDifference);
      }
      e -= hessian.partialPivLu().solve(residual);
    }
    throw SolverError("no equilibrium of the strip");
  }

 private:
  [[nodiscard]] Eigen::VectorXd gradient(const Eigen::VectorXd& e) const {
    const std::size_t count = places_.size();
    const auto corner = [&](std::size_t k) -> Vector3d {
      if (k == 0) return {-sheet_.support, 0, 0};
      if (k > count) return {sheet_.support, 0, 0};
      return Vector3d(places_[k - 1], 0, 0) + e.segment<3>(static_cast<Eigen::Index>(3 * (k - 1)));
    };
    const auto rest = [&](std::size_t k) {
      return k == 0 ? -sheet_.support : k > count ? sheet_.support : places_[k - 1];
    };
    Eigen::VectorXd result = Eigen::VectorXd::Zero(e.size());
    for (std::size_t k = 0; k <= count; ++k) {
      const Vector3d way = corner(k + 1) - corner(k);
      const double length = rest(k + 1) - rest(k), stretched = way.norm();
      const Vector3d pull =
          (sheet_.tension + sheet_.axial * (stretched - length) / length) / stretched * way;
      if (k > 0) result.segment<3>(static_cast<Eigen::Index>(3 * (k - 1))) -= pull;
      if (k < count) result.segment<3>(static_cast<Eigen::Index>(3 * k)) += pull;
    }
    for (std::size_t k = 0; k < count; ++k)
      result[static_cast<Eigen::Index>(3 * k + 1)] +=
          sheet_.lateral * e[static_cast<Eigen::Index>(3 * k + 1)];
    return result;
  }

  probing::Sheet sheet_;
  std::vector<double> places_;
};

void compare_on_strip(double depth) {
  const probing::Sheet sheet;
  double check = 0;
  print_row("strip of the closed-form sheet", depth, [&](double distance) {
    const double x = distance / 2;
    const Eigen::Matrix3Xd both = Vector3d(0, 0, depth).replicate(1, 2);
    const Vector3d alone = Strip(sheet, {-x}).forces(both.leftCols(1));
    const Vector3d near = Strip(sheet, {-x, x}).forces(both).col(0);
    // The same energy as the specimen's, where there is one tool.
    check = std::max(
        check, (probing::displacement_at(sheet, -x, 0, alone) - Vector3d(0, 0, depth)).norm());
    return alone.z() / near.z() - 1;
  });
  std::printf("  one tool: `displacement_at` differs by at most %.1e mm\n", check);
}

// Flat punches of radius a on a half-space, not too near (Johnson, Contact Mechanics, 3.4): each
// lowers the surface below the other by (2 / pi) asin(a / r) of its own depth.
void compare_on_half_space(double depth) {
  const double radius = std::sqrt(kBall * depth);  // of the contact of a ball (Hertz)
  print_row("half-space, flat punches", depth,
            [&](double distance) { return 2 / std::numbers::pi * std::asin(radius / distance); });
}

}  // namespace

void print_near_tools() {
  std::printf(
      "\nTwo balls of %.0f mm radius at the same depth: how much too large the force of a tool "
      "alone is [%%]\n\n| object | depth [mm] |",
      kBall);
  for (const double distance : kDistances) std::printf(" %.1f mm |", distance);
  std::printf("\n");
  for (const double depth : {1.0, 2.5, 5.0}) compare_on_half_space(depth);
  for (const double depth : {5.0, 15.0}) compare_on_strip(depth);
  for (const double height : {20.0, 60.0})
    compare_on_solid(trade_block(height), Vector3d::UnitX(), 2.5);
  for (const Vector3d& along : {Vector3d::UnitX().eval(), Vector3d::UnitY().eval()})
    compare_on_solid(trade_sheet(), along, 5);
}

}  // namespace palpate::bench
