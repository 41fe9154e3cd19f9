// SPDX-FileCopyrightText: Palpate contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <map>
#include <optional>

namespace palpate::probing {

/// The place at which a tip began to slide along a surface.
struct TipSlide {
  std::size_t last_held = 0;                        ///< moment until which the tip held
  Eigen::Vector3d tip = Eigen::Vector3d::Zero();    ///< [mm] its position then
  Eigen::Vector3d force = Eigen::Vector3d::Zero();  ///< [N] under which it slid
};

/// Finds slides in the moments of a press. An elastic object has one shape under each force, so a
/// tip that holds is at one place under each force: if it comes elsewhere under the same force, it
/// has slid in between. Only motion across the force counts, because depths creep.
class TipSlides {
 public:
  /// \param touch the moment at which the press begins
  /// \param same_force [N] components of forces are the same if they differ by less; > 0
  /// \param slide_length [mm] a tip that is further away has slid; > 0
  TipSlides(std::size_t touch, const Eigen::Vector3d& tip, const Eigen::Vector3d& force,
            double same_force, double slide_length);

  /// The slide, if the tip has slid by this moment.
  [[nodiscard]] std::optional<TipSlide> add(std::size_t moment, const Eigen::Vector3d& tip,
                                            const Eigen::Vector3d& force);
  /// The same for the tip that leaves the surface, where it must be as it was at the touch.
  [[nodiscard]] std::optional<TipSlide> release(const Eigen::Vector3d& tip,
                                                const Eigen::Vector3d& force) const;

 private:
  struct Visit {
    std::size_t moment = 0;
    Eigen::Vector3d tip, force;
    double compliance = 0;  // [mm/N] largest until then
  };
  [[nodiscard]] std::optional<TipSlide> compare(const Visit& visit, const Eigen::Vector3d& tip,
                                                const Eigen::Vector3d& force) const;

  double same_force_, slide_length_;
  Visit touch_;
  std::map<std::array<double, 3>, Visit> visits_;  // by force, in steps of same_force
  double compliance_ = 0;
};

}  // namespace palpate::probing
